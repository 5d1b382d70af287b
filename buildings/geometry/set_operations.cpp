// Unions, intersections and differences of polygons, and what is measured by them: by labels of the faces between all borders. The floating point
// versions of Boost.Geometry 1.74 lose whole polygons where turned rectangles have edges in common, as walls do.
#include <algorithm>
#include <utility>

#include "buildings/geometry/planar_map.h"
#include "buildings/geometry/polygon.h"
#include "buildings/geometry/rings.h"

namespace skyquilt::buildings {
namespace {

constexpr double kSamePlace = 1e-6;  // metres
constexpr double kSliver = 1e-6;     // square metres

struct BoundedPolygon {
  const Polygon* polygon;
  Eigen::Vector2d least, most;
};

// One of two sets of polygons.
class PolygonSet {
 public:
  explicit PolygonSet(std::span<const Polygon> polygons) {
    for (const Polygon& polygon : polygons) {
      if (polygon.outer.size() < 3) continue;
      BoundedPolygon bounded{&polygon, polygon.outer.front(), polygon.outer.front()};
      for (const Eigen::Vector2d& p : polygon.outer) {
        bounded.least = bounded.least.cwiseMin(p);
        bounded.most = bounded.most.cwiseMax(p);
      }
      polygons_.push_back(bounded);
    }
  }

  void AddBorders(std::vector<Segment>* segments) const {
    const auto add = [&](const Ring& ring) {
      for (size_t i = 0; i < ring.size(); ++i) segments->push_back({ring[i], ring[(i + 1) % ring.size()]});
    };
    for (const BoundedPolygon& bounded : polygons_) {
      add(bounded.polygon->outer);
      for (const Ring& hole : bounded.polygon->holes) add(hole);
    }
  }

  bool Covers(const Eigen::Vector2d& p) const {
    return std::any_of(polygons_.begin(), polygons_.end(), [&](const BoundedPolygon& bounded) {
      return (p.array() >= bounded.least.array()).all() && (p.array() <= bounded.most.array()).all() && Contains(*bounded.polygon, p);
    });
  }

 private:
  std::vector<BoundedPolygon> polygons_;
};

// The faces between the borders of both sets, and which set covers them.
struct Overlay {
  PlanarMap map;
  std::vector<bool> in_a, in_b;
};

Overlay OverlayOf(std::span<const Polygon> a, std::span<const Polygon> b) {
  const PolygonSet set_a(a), set_b(b);
  std::vector<Segment> segments;
  set_a.AddBorders(&segments);
  set_b.AddBorders(&segments);
  Overlay overlay{PlanarMap(segments, kSamePlace), {}, {}};
  for (const Eigen::Vector2d& place : overlay.map.PointsInFaces()) {
    overlay.in_a.push_back(set_a.Covers(place));
    overlay.in_b.push_back(set_b.Covers(place));
  }
  return overlay;
}

template <typename Wanted>
std::vector<Polygon> PolygonsOf(const Overlay& overlay, const Wanted& wanted) {
  std::vector<int> label;
  for (size_t f = 0; f < overlay.in_a.size(); ++f) label.push_back(wanted(overlay.in_a[f], overlay.in_b[f]) ? 0 : -1);
  std::vector<Polygon> polygons;
  for (const MapRegion& region : overlay.map.Regions(label, kSamePlace)) {
    Polygon polygon = overlay.map.OutlineOf(region);
    std::erase_if(polygon.holes, [](const Ring& hole) { return !(SignedArea(hole) < -kSliver); });
    if (Area(polygon) > kSliver) polygons.push_back(std::move(polygon));
  }
  return polygons;
}

}  // namespace

std::vector<Polygon> Union(std::span<const Polygon> polygons) {
  return PolygonsOf(OverlayOf(polygons, {}), [](bool in_a, bool) { return in_a; });
}

std::vector<Polygon> Intersection(const Polygon& a, const Polygon& b) {
  return PolygonsOf(OverlayOf({&a, 1}, {&b, 1}), [](bool in_a, bool in_b) { return in_a && in_b; });
}

std::vector<Polygon> Difference(const Polygon& a, std::span<const Polygon> taken) {
  return PolygonsOf(OverlayOf({&a, 1}, taken), [](bool in_a, bool in_b) { return in_a && !in_b; });
}

double IntersectionOverUnion(std::span<const Polygon> a, std::span<const Polygon> b) {
  const Overlay overlay = OverlayOf(a, b);
  const std::vector<double> area = overlay.map.FaceAreas();
  double shared = 0.0, all = 0.0;
  for (size_t f = 0; f < area.size(); ++f) {
    shared += overlay.in_a[f] && overlay.in_b[f] ? area[f] : 0.0;
    all += overlay.in_a[f] || overlay.in_b[f] ? area[f] : 0.0;
  }
  return all > 0.0 ? std::clamp(shared / all, 0.0, 1.0) : 0.0;
}

}  // namespace skyquilt::buildings
