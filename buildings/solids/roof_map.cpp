#include "buildings/solids/roof_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace skyquilt::buildings {
namespace {

// Faces must be planar within 10 mm and vertices 1 mm apart after rounding to 1 mm.
constexpr double kSnap = 0.003;        // metres in plan
constexpr double kSameHeight = 0.004;  // metres
constexpr double kSamePlane = 0.001;   // metres between planes that count as one

}  // namespace

RoofMap::RoofMap(std::span<const RoofFacet> facets, double ground_z) : ground_z_(ground_z), map_({}, kSnap) {
  FindPlanes(facets);
  std::vector<Segment> segments;
  const auto add = [&](const std::vector<Eigen::Vector2d>& ring) {
    for (size_t i = 0; i < ring.size(); ++i) segments.push_back({ring[i], ring[(i + 1) % ring.size()]});
  };
  for (const RoofFacet& facet : facets) {
    add(facet.outline.outer);
    for (const auto& hole : facet.outline.holes) add(hole);
  }
  map_ = PlanarMap(segments, kSnap);
  FindLabels(facets);
  const std::vector<Segment> crossings = Crossings();
  if (!crossings.empty()) {
    segments.insert(segments.end(), crossings.begin(), crossings.end());
    map_ = PlanarMap(segments, kSnap);
    FindLabels(facets);
  }
  FindColumns();
}

void RoofMap::FindPlanes(std::span<const RoofFacet> facets) {
  const auto same = [](const RoofFacet& facet, const RoofFacet& plane) {
    const auto near = [&](const Eigen::Vector2d& p) { return std::abs(facet.HeightAt(p) - plane.HeightAt(p)) <= kSamePlane; };
    return std::all_of(facet.outline.outer.begin(), facet.outline.outer.end(), near) &&
           std::all_of(plane.outline.outer.begin(), plane.outline.outer.end(), near);
  };
  for (const RoofFacet& facet : facets) {
    const auto found = std::find_if(plane_.begin(), plane_.end(), [&](const RoofFacet& plane) { return same(facet, plane); });
    label_of_facet_.push_back(static_cast<int>(found - plane_.begin()));
    if (found == plane_.end()) plane_.push_back(facet);
  }
}

void RoofMap::FindLabels(std::span<const RoofFacet> facets) {
  label_.clear();
  for (const Eigen::Vector2d& place : map_.PointsInFaces()) {
    const auto found = std::find_if(facets.begin(), facets.end(), [&](const RoofFacet& facet) { return Contains(facet.outline, place); });
    label_.push_back(found == facets.end() ? -1 : label_of_facet_[static_cast<size_t>(found - facets.begin())]);
  }
}

// Places within edges where the roof that was higher becomes the lower one.
std::vector<Segment> RoofMap::Crossings() const {
  std::vector<Segment> crossings;
  for (uint32_t h = 0; h < map_.HalfEdges(); h += 2) {
    const int left = LabelOf(h), right = LabelOf(PlanarMap::Twin(h));
    if (left == right) continue;
    const Eigen::Vector2d &a = map_.Vertex(map_.From(h)), &b = map_.Vertex(map_.To(h));
    const double step_a = HeightAt(left, a) - HeightAt(right, a), step_b = HeightAt(left, b) - HeightAt(right, b);
    if (std::min(step_a, step_b) >= -kSameHeight || std::max(step_a, step_b) <= kSameHeight) continue;
    const Eigen::Vector2d place = a + step_a / (step_a - step_b) * (b - a);
    crossings.push_back({place, place});
  }
  return crossings;
}

void RoofMap::FindColumns() {
  std::vector<std::map<int, double>> heights(map_.Vertices());
  for (uint32_t h = 0; h < map_.HalfEdges(); ++h) {
    const int left = LabelOf(h), right = LabelOf(PlanarMap::Twin(h));
    if (left == right) continue;
    for (const uint32_t v : {map_.From(h), map_.To(h)}) heights[v][left] = HeightAt(left, map_.Vertex(v));
  }
  // Roofs that still cross within an edge do so beside its end: there they meet.
  for (uint32_t h = 0; h < map_.HalfEdges(); h += 2) {
    const int left = LabelOf(h), right = LabelOf(PlanarMap::Twin(h));
    if (left == right) continue;
    const auto step = [&](uint32_t v) { return heights[v][left] - heights[v][right]; };
    const double step_a = step(map_.From(h)), step_b = step(map_.To(h));
    if (std::min(step_a, step_b) >= -kSameHeight || std::max(step_a, step_b) <= kSameHeight) continue;
    const uint32_t near = std::abs(step_a) < std::abs(step_b) ? map_.From(h) : map_.To(h);
    const double mean = 0.5 * (heights[near][left] + heights[near][right]);
    heights[near][left] = heights[near][right] = mean;
  }
  column_.assign(map_.Vertices(), {});
  for (uint32_t v = 0; v < map_.Vertices(); ++v) {
    std::vector<std::pair<double, int>> rising;
    for (const auto& [label, height] : heights[v]) rising.emplace_back(height, label);
    std::sort(rising.begin(), rising.end());
    Column& column = column_[v];
    for (size_t begin = 0, end = 0; begin < rising.size(); begin = end) {
      double sum = 0.0;
      for (end = begin; end < rising.size() && (end == begin || rising[end].first - rising[end - 1].first <= kSameHeight); ++end) {
        sum += rising[end].first;
        column.level[rising[end].second] = static_cast<int>(column.height.size());
      }
      column.height.push_back(sum / static_cast<double>(end - begin));
    }
  }
}

}  // namespace skyquilt::buildings
