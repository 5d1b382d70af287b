#include "partition/auto_grid.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace skyquilt::partition {
namespace {

// Ever more blocks, as square as they can be: 1 x 1 first, then one row or column more, or both.
class GridSequence {
 public:
  GridSequence(const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu)
      : min_(min_enu), max_(max_enu), side_((max_enu - min_enu).maxCoeff()) {}

  BlockGrid First() const { return SplitByCount(min_, max_, 1, 1); }
  // Nothing when the next would have more than kMaxBlocks.
  std::optional<BlockGrid> After(const BlockGrid& grid) {
    const Eigen::Vector2d extent = max_ - min_;
    for (;;) {
      side_ *= 0.9;
      const int rows = std::max(1, static_cast<int>(std::lround(extent.y() / side_)));
      const int columns = std::max(1, static_cast<int>(std::lround(extent.x() / side_)));
      if (static_cast<double>(rows) * columns > kMaxBlocks) return std::nullopt;
      if (rows != grid.rows() || columns != grid.columns()) return SplitByCount(min_, max_, rows, columns);
    }
  }
  // With the rows of one and the columns of the other, so that the longer side is divided.
  BlockGrid Between(const BlockGrid& fewer, const BlockGrid& more) const {
    const bool wide = (max_ - min_).x() >= (max_ - min_).y();
    return wide ? SplitByCount(min_, max_, fewer.rows(), more.columns()) : SplitByCount(min_, max_, more.rows(), fewer.columns());
  }

 private:
  Eigen::Vector2d min_, max_;
  double side_;
};

std::string TimeReason(double block_steps) {
  return fmt::format("as many as the time budget can train (about {:.0f} steps in all, {:.0f} a block)", block_steps, kBlockSteps);
}

}  // namespace

AutoGrid ChooseGrid(const AutoGridInput& input) {
  const double by_pixels = std::max(1.0, std::floor(input.training_pixels / input.pixels_per_block));
  const double by_time = std::max(1.0, std::floor(input.block_steps / kBlockSteps));
  const auto is_allowed = [&](const BlockGrid& grid) { return input.n_blocks(grid) <= std::min(by_pixels, by_time); };
  GridSequence sequence(input.min_enu, input.max_enu);
  std::vector<BlockGrid> grids = {sequence.First()};
  BlockGrid last = grids.front();
  std::string reason = "as few as hold the surface in their tables";
  while (!input.fits(last)) {
    std::optional<BlockGrid> next = sequence.After(last);
    if (!next) {
      reason = fmt::format("more than {} are not made", kMaxBlocks);
      break;
    }
    if (next->rows() > last.rows() && next->columns() > last.columns()) {
      BlockGrid between = sequence.Between(last, *next);
      if (is_allowed(between)) grids.push_back(std::move(between));
    }
    if (!is_allowed(*next)) {
      reason = by_time < by_pixels ? TimeReason(input.block_steps)
                                   : fmt::format("as many as the photos' {:.3g} million pixels can train ({:.3g} million a block)",
                                                 1e-6 * input.training_pixels, 1e-6 * input.pixels_per_block);
      break;
    }
    grids.push_back(*next);
    last = *std::move(next);
  }
  if (!std::isfinite(input.block_steps)) return {grids.back(), reason};
  while (grids.size() > 1 && input.least_share(grids.back()) * input.block_steps < kFewestSteps) {
    grids.pop_back();
    reason = TimeReason(input.block_steps) + fmt::format("; of more, the smallest would get fewer than {:.0f}", kFewestSteps);
  }
  return {grids.back(), reason};
}

}  // namespace skyquilt::partition
