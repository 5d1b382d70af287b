#include "buildings/shape/wall_lines.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::buildings {
namespace {

constexpr double kBin_m = 0.1;
constexpr double kWallWidth_m = 0.3;  // standard deviation of wall points across their wall
constexpr double kEdgeWidth_m = 0.25;
constexpr double kApart_m = 1.0;
constexpr double kLeastWall_m2 = 2.5;
constexpr double kLeastEdge_m = 1.5;
constexpr double kWallPerEdge_m = 0.25;  // square metres of wall per metre of edge, so that the wall says where the line is
constexpr double kWallHeight_m = 2.5;    // that makes a metre of wall worth as much as a metre of edge
constexpr double kFaces = 0.906;         // cosine of 25 degrees

// LineEvidence along an axis, in bins.
class LineEvidence {
 public:
  LineEvidence(double from, double to) : from_(from), bin_(static_cast<size_t>(std::max(1.0, std::ceil((to - from) / kBin_m)))) {}

  void Add(double at, double weight) {
    const double place = std::floor((at - from_) / kBin_m);
    if (place >= 0.0 && place < static_cast<double>(bin_.size())) bin_[static_cast<size_t>(place)] += weight;
  }
  double Centre(size_t i) const { return from_ + (static_cast<double>(i) + 0.5) * kBin_m; }

  struct Peak {
    double at = 0.0, weight = 0.0;
  };
  // Maxima of the evidence seen through a Gaussian of height 1: the weight within about its width.
  std::vector<Peak> Peaks(double reach_m, double least) const {
    const int half = static_cast<int>(std::ceil(2.5 * reach_m / kBin_m)), n = static_cast<int>(bin_.size());
    std::vector<double> smooth(bin_.size(), 0.0);
    for (int i = 0; i < n; ++i) {
      for (int k = std::max(0, i - half); k <= std::min(n - 1, i + half); ++k) {
        const double d = (i - k) * kBin_m / reach_m;
        smooth[static_cast<size_t>(i)] += std::exp(-0.5 * d * d) * bin_[static_cast<size_t>(k)];
      }
    }
    std::vector<Peak> peaks;
    for (int i = 0; i < n; ++i) {
      const double here = smooth[static_cast<size_t>(i)];
      const double before = i > 0 ? smooth[static_cast<size_t>(i) - 1] : 0.0, after = i + 1 < n ? smooth[static_cast<size_t>(i) + 1] : 0.0;
      if (here >= least && here > before && here >= after) peaks.push_back({MeanAround(i, half), here});
    }
    return peaks;
  }

 private:
  // Three steps of mean shift from the bin.
  double MeanAround(int middle, int half) const {
    double at = Centre(static_cast<size_t>(middle));
    for (int step = 0; step < 3; ++step) {
      double weight = 0.0, sum = 0.0;
      for (int k = std::max(0, middle - half); k <= std::min(static_cast<int>(bin_.size()) - 1, middle + half); ++k) {
        const double x = Centre(static_cast<size_t>(k));
        const double near = std::abs(x - at) <= 0.4 ? bin_[static_cast<size_t>(k)] : 0.0;
        weight += near;
        sum += near * x;
      }
      if (!(weight > 0.0)) break;
      at = sum / weight;
    }
    return at;
  }

  double from_;
  std::vector<double> bin_;
};

double Strength(const WallLine& line) {
  return line.edge_m + line.wall_m2 / kWallHeight_m;
}

class LineFinder {
 public:
  LineFinder(const AxisPoints& points, const RoofRaster& raster, const EdgesAcross& edges, int axis)
      : points_(points), raster_(raster), edges_(edges), axis_(axis) {}

  std::vector<WallLine> Find() {
    AddWalls();
    AddEdges();
    std::stable_sort(lines_.begin(), lines_.end(), [](const WallLine& a, const WallLine& b) { return Strength(a) > Strength(b); });
    if (lines_.size() > static_cast<size_t>(kMostLines)) lines_.resize(static_cast<size_t>(kMostLines));
    AddOutermost();
    std::sort(lines_.begin(), lines_.end(), [](const WallLine& a, const WallLine& b) { return a.at < b.at; });
    return lines_;
  }

 private:
  double First() const { return raster_.origin[axis_]; }
  double Last() const { return First() + raster_.cell_m * (axis_ == 0 ? raster_.columns : raster_.rows); }

  void AddWalls() {
    const double area = points_.spacing_m * points_.spacing_m;
    std::vector<WallLine> walls;
    for (const double side : {1.0, -1.0}) {
      LineEvidence evidence(First() - 1.0, Last() + 1.0);
      for (const AxisPoint& point : points_.steep) {
        if (side * point.normal[axis_] > kFaces * point.normal.head<2>().norm()) evidence.Add(point.at[axis_], area);
      }
      for (const LineEvidence::Peak& peak : evidence.Peaks(kWallWidth_m, kLeastWall_m2)) walls.push_back({peak.at, peak.weight, 0.0});
    }
    std::stable_sort(walls.begin(), walls.end(), [](const WallLine& a, const WallLine& b) { return a.wall_m2 > b.wall_m2; });
    for (const WallLine& wall : walls) Merge(wall);
  }

  void AddEdges() {
    std::vector<WallLine> found;
    for (const RoofEdge kind : {RoofEdge::kOutline, RoofEdge::kStep}) {
      LineEvidence evidence(First(), Last());
      for (int lane = 0; lane < edges_.lanes; ++lane) {
        for (int border = 0; border < edges_.borders; ++border) {
          if (edges_.At(lane, border) == kind) evidence.Add(First() + border * raster_.cell_m + 1e-9, raster_.cell_m);
        }
      }
      for (const LineEvidence::Peak& peak : evidence.Peaks(kEdgeWidth_m, kLeastEdge_m)) found.push_back({peak.at, 0.0, peak.weight});
    }
    std::stable_sort(found.begin(), found.end(), [](const WallLine& a, const WallLine& b) { return a.edge_m > b.edge_m; });
    for (const WallLine& edge : found) Merge(edge);
  }

  // Into the nearest line, or as a new one.
  void Merge(const WallLine& line) {
    WallLine* nearest = nullptr;
    for (WallLine& old : lines_) {
      if (std::abs(old.at - line.at) < kApart_m && (nearest == nullptr || std::abs(old.at - line.at) < std::abs(nearest->at - line.at)))
        nearest = &old;
    }
    if (nearest == nullptr) {
      lines_.push_back(line);
      return;
    }
    // A few steep points beside a long edge are a chimney or a bush.
    if (nearest->edge_m == 0.0 && line.wall_m2 == 0.0 && nearest->wall_m2 < kWallPerEdge_m * line.edge_m) nearest->at = line.at;
    nearest->wall_m2 += line.wall_m2;
    nearest->edge_m += line.edge_m;
  }

  // The first and last place where the roofs are at least a metre wide, unless there is a line.
  void AddOutermost() {
    const int cells = axis_ == 0 ? raster_.columns : raster_.rows, lanes = axis_ == 0 ? raster_.rows : raster_.columns;
    const auto is_wide = [&](int cell) {
      int count = 0;
      for (int lane = 0; lane < lanes; ++lane) count += raster_.covered[axis_ == 0 ? raster_.Index(cell, lane) : raster_.Index(lane, cell)];
      return count * raster_.cell_m >= kApart_m;
    };
    int first = 0, last = cells;
    while (first < last && !is_wide(first)) ++first;
    while (last > first && !is_wide(last - 1)) --last;
    if (first == last) {
      first = 0;
      last = cells;
    }
    for (const double at : {First() + first * raster_.cell_m, First() + last * raster_.cell_m}) {
      const bool is_there = std::any_of(lines_.begin(), lines_.end(), [&](const WallLine& line) { return std::abs(line.at - at) < 1.5 * kApart_m; });
      if (!is_there) lines_.push_back({at, 0.0, 0.0});
    }
    if (lines_.size() < 2) lines_ = {{First() + first * raster_.cell_m, 0.0, 0.0}, {First() + last * raster_.cell_m, 0.0, 0.0}};
  }

  const AxisPoints& points_;
  const RoofRaster& raster_;
  const EdgesAcross& edges_;
  int axis_;
  std::vector<WallLine> lines_;
};

}  // namespace

WallLines FindWallLines(const AxisPoints& points, const RoofRaster& raster, const std::array<EdgesAcross, 2>& edges) {
  return {LineFinder(points, raster, edges[0], 0).Find(), LineFinder(points, raster, edges[1], 1).Find()};
}

}  // namespace skyquilt::buildings
