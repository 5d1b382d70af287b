#include <algorithm>
#include <limits>

#include "surface/texture/charts.h"

namespace skyquilt::surface {
namespace {

// A triangle that covers no texel's centre may share a texel with others of the same sheet, whose depths there differ by a few texels at most,
// because the surface of a chart is not steeper than kLeastChartCosine.
constexpr double kSameSheetTexels = 5.0;

struct MaskTexel {
  int32_t chart = 0;  // that covers its centre; negative: only a small triangle of that chart lies in it; 0: nothing
  float depth = 0.0F;
};

// Which chart covers which texel of a piece.
class ChartMask {
 public:
  ChartMask(const TileGeometry& geometry, const TexelLattice& lattice, int direction, const Eigen::Vector2i& corner, const Eigen::Vector2i& size)
      : geometry_(geometry),
        lattice_(lattice),
        direction_(direction),
        corner_(corner),
        width_(static_cast<size_t>(size.x())),
        texel_(static_cast<size_t>(size.x()) * static_cast<size_t>(size.y())) {}

  // Enters the triangle unless it lies before or behind another one of this chart.
  bool Place(size_t t, int32_t chart) {
    const TexelTriangle corners = lattice_.Of(direction_, geometry_, t);
    std::array<double, 3> depth{};
    for (size_t i = 0; i < 3; ++i) depth[i] = lattice_.DepthAt(direction_, geometry_.Corner(t, i));
    covered_.clear();
    bool free = true;
    ForEachCentreInside(corners, [&](int x, int y, double b1, double b2) {
      const size_t index = IndexOf(x, y);
      const double z = depth[0] + b1 * (depth[1] - depth[0]) + b2 * (depth[2] - depth[0]);
      free = free && texel_[index].chart != chart && !(texel_[index].chart == -chart && IsOtherSheet(texel_[index], z));
      covered_.emplace_back(index, static_cast<float>(z));
    });
    if (!free) return false;
    for (const auto& [index, z] : covered_) texel_[index] = {chart, z};
    return !covered_.empty() || PlaceSmall(corners, depth, chart);
  }

 private:
  static bool IsOtherSheet(const MaskTexel& texel, double depth) { return std::abs(static_cast<double>(texel.depth) - depth) > kSameSheetTexels; }

  size_t IndexOf(int x, int y) const { return static_cast<size_t>(y - corner_.y()) * width_ + static_cast<size_t>(x - corner_.x()); }

  bool PlaceSmall(const TexelTriangle& corners, const std::array<double, 3>& depth, int32_t chart) {
    const Eigen::Vector2d middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    const double z = (depth[0] + depth[1] + depth[2]) / 3.0;
    const size_t last = texel_.size() - 1;  // for rounding at the far corner
    MaskTexel& texel = texel_[std::min(IndexOf(static_cast<int>(std::floor(middle.x())), static_cast<int>(std::floor(middle.y()))), last)];
    if (texel.chart == chart || texel.chart == -chart) return !IsOtherSheet(texel, z);
    texel = {-chart, static_cast<float>(z)};
    return true;
  }

  const TileGeometry& geometry_;
  const TexelLattice& lattice_;
  int direction_;
  Eigen::Vector2i corner_;
  size_t width_;
  std::vector<MaskTexel> texel_;
  std::vector<std::pair<size_t, float>> covered_;
};

// Texels that the triangles reach into; false when they are more than max_size wide or high.
bool BoundTexels(const TileGeometry& geometry, const TexelLattice& lattice, int max_size, Chart* chart) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const uint32_t t : chart->triangle) {
    for (const Eigen::Vector2d& corner : lattice.Of(chart->direction, geometry, t)) {
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  low = low.array().floor();
  high = high.array().floor();
  if (!((high - low).maxCoeff() < max_size) || !(low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff() < 1e9)) return false;
  chart->corner = low.cast<int>();
  chart->size = high.cast<int>() - chart->corner + Eigen::Vector2i::Ones();
  return true;
}

// Where a triangle is in the sorted list of the piece.
std::optional<size_t> PlaceIn(const Chart& piece, uint32_t t) {
  const auto found = std::lower_bound(piece.triangle.begin(), piece.triangle.end(), t);
  if (found == piece.triangle.end() || *found != t) return std::nullopt;
  return static_cast<size_t>(found - piece.triangle.begin());
}

}  // namespace

std::optional<std::vector<Chart>> SplitOverlaps(const TileGeometry& geometry, const TexelLattice& lattice, const Chart& piece, int max_size) {
  std::vector<Chart> charts;
  if (piece.triangle.empty()) return charts;
  Chart whole = piece;
  if (!BoundTexels(geometry, lattice, max_size, &whole)) return std::nullopt;
  ChartMask mask(geometry, lattice, piece.direction, whole.corner, whole.size);
  // By place in the piece: whether a chart has it, and the last chart that tried it.
  std::vector<bool> placed(piece.triangle.size(), false);
  std::vector<int32_t> tried(piece.triangle.size(), 0);
  std::vector<size_t> open;
  for (size_t first = 0; first < piece.triangle.size(); ++first) {
    if (placed[first]) continue;
    Chart chart;
    chart.direction = piece.direction;
    const auto number = static_cast<int32_t>(charts.size() + 1);
    open.assign(1, first);
    tried[first] = number;
    for (size_t next = 0; next < open.size(); ++next) {
      const uint32_t t = piece.triangle[open[next]];
      if (!mask.Place(t, number)) continue;
      placed[open[next]] = true;
      chart.triangle.push_back(t);
      for (const int32_t other : geometry.neighbor[t]) {
        const std::optional<size_t> place = other < 0 ? std::nullopt : PlaceIn(piece, static_cast<uint32_t>(other));
        if (!place || placed[*place] || tried[*place] == number) continue;
        tried[*place] = number;
        open.push_back(*place);
      }
    }
    BoundTexels(geometry, lattice, max_size, &chart);
    charts.push_back(std::move(chart));
  }
  return charts;
}

}  // namespace skyquilt::surface
