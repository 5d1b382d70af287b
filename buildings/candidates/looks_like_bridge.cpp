#include "buildings/candidates/looks_like_bridge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "core/linear/linear.h"

namespace skyquilt::buildings {
namespace {

constexpr double kBeyond_m = 1.2;  // beyond the border
constexpr double kLevelStep_m = 0.5;
constexpr double kEndAtEdge_m = 2.0;
constexpr double kFacesEnd = 0.7;  // cosine between the direction of the deck and the border at its ends
constexpr double kEndShare = 0.5;

// A cell of the border beyond which the surface goes on, or nobody knows.
struct OpenCell {
  Eigen::Vector2d out;
  bool continues;
};

// Cells outside that are no holes of the mask.
CellMask CellsAround(const CellMask& mask) {
  CellMask outside(mask.columns, mask.rows), around(mask.columns, mask.rows);
  for (size_t i = 0; i < mask.value.size(); ++i) outside.value[i] = mask.value[i] == 0 ? 1 : 0;
  const auto width = static_cast<uint32_t>(mask.columns);
  for (const std::vector<uint32_t>& part : ConnectedParts(outside)) {
    const bool open = std::any_of(part.begin(), part.end(), [&](uint32_t cell) {
      const auto column = static_cast<int>(cell % width), row = static_cast<int>(cell / width);
      return column == 0 || row == 0 || column == mask.columns - 1 || row == mask.rows - 1;
    });
    if (!open) continue;
    for (const uint32_t cell : part) around.value[cell] = 1;
  }
  return around;
}

class Deck {
 public:
  Deck(const RoofArea& area, const TopRaster& top, const GroundGrid& ground, const SurveyEdge& edge, double min_height_m)
      : area_(area), top_(top), ground_(ground), edge_(edge), min_height_m_(min_height_m), around_(CellsAround(area.mask)) {
    const Eigen::Vector2d shift = (area.origin - top.origin) / area.cell_m;
    left_ = static_cast<int>(std::lround(shift.x()));
    low_ = static_cast<int>(std::lround(shift.y()));
  }

  bool RunsOn() const {
    const std::vector<OpenCell> open = OpenCells();
    Eigen::Matrix2d directions = Eigen::Matrix2d::Zero();
    for (const OpenCell& cell : open) {
      if (cell.continues) directions += cell.out * cell.out.transpose();
    }
    if (directions.isZero()) return false;
    const Eigen::Vector2d along = linear::SymmetricEigen(directions).vectors.col(1);
    double first = 0.0, last = 0.0;
    size_t known_ends = 0;
    const double least = kEndShare * WidthAcross(along) / area_.cell_m;
    for (const double side : {1.0, -1.0}) {
      double all = 0.0, known = 0.0;
      for (const OpenCell& cell : open) {
        if (side * cell.out.dot(along) < kFacesEnd) continue;
        all += 1.0;
        if (cell.continues) known += 1.0;
      }
      (side > 0.0 ? last : first) = all;
      if (known >= least) ++known_ends;
    }
    return known_ends > 0 && first >= least && last >= least;
  }

 private:
  // Area over length: the mean width of a deck that need not be straight.
  double WidthAcross(const Eigen::Vector2d& along) const {
    double least = std::numeric_limits<double>::infinity(), most = -least, cells = 0.0;
    for (int row = 0; row < area_.mask.rows; ++row) {
      for (int column = 0; column < area_.mask.columns; ++column) {
        if (area_.mask.value[area_.mask.Index(column, row)] == 0) continue;
        const double at = area_.cell_m * along.dot(Eigen::Vector2d(column, row));
        least = std::min(least, at);
        most = std::max(most, at);
        cells += 1.0;
      }
    }
    return cells * area_.cell_m * area_.cell_m / (most - least + area_.cell_m);
  }

  std::vector<OpenCell> OpenCells() const {
    const CellMask& mask = area_.mask;
    const auto is_around = [&](int column, int row) { return !mask.Inside(column, row) || around_.value[mask.Index(column, row)] != 0; };
    const auto reach = static_cast<int>(std::floor(kBeyond_m / area_.cell_m));
    std::vector<OpenCell> open;
    for (int row = 0; row < mask.rows; ++row) {
      for (int column = 0; column < mask.columns; ++column) {
        if (mask.value[mask.Index(column, row)] == 0) continue;
        if (!is_around(column - 1, row) && !is_around(column + 1, row) && !is_around(column, row - 1) && !is_around(column, row + 1)) continue;
        const auto roof = static_cast<double>(area_.roof_z[mask.Index(column, row)]);
        Eigen::Vector2d out = Eigen::Vector2d::Zero();
        int seen = 0, level = 0;
        for (int r = row - reach; r <= row + reach; ++r) {
          for (int c = column - reach; c <= column + reach; ++c) {
            if (std::hypot(c - column, r - row) > reach || !is_around(c, r)) continue;
            out += Eigen::Vector2d(c - column, r - row);
            const double z = top_.TopAt(c + left_, r + low_);
            if (std::isnan(z)) continue;
            ++seen;
            if (std::abs(z - roof) <= kLevelStep_m && z - ground_.At(area_.Centre(c, r)) < min_height_m_) ++level;
          }
        }
        if (out.isZero()) continue;
        const bool continues = 2 * level > seen;
        if (continues || edge_.DistanceTo(area_.Centre(column, row)) <= kEndAtEdge_m) open.push_back({out.normalized(), continues});
      }
    }
    return open;
  }

  const RoofArea& area_;
  const TopRaster& top_;
  const GroundGrid& ground_;
  const SurveyEdge& edge_;
  double min_height_m_;
  CellMask around_;
  int left_ = 0, low_ = 0;
};

}  // namespace

bool LooksLikeBridge(const RoofArea& area, const TopRaster& top, const GroundGrid& ground, const SurveyEdge& edge, double min_height_m) {
  return Deck(area, top, ground, edge, min_height_m).RunsOn();
}

}  // namespace skyquilt::buildings
