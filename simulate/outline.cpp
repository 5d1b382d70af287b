#include "simulate/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulate/plane_turn.h"

namespace skyquilt::simulate {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

// How far the roof reaches beyond the wall at each side of the part's own axes.
double OverhangAt(const Building& part, size_t side) {
  return part.shared[side] ? 0.0 : part.RoofOverhang();
}

// The part along the axes of the outline, with its origin.
class OutlineAxes {
 public:
  explicit OutlineAxes(const Building& main) : main_(main), turn_(Vector2d::Zero(), main.yaw_deg) {}

  Rectangle2d Walls(const Building& part) const { return Around(part, 0.0); }
  Rectangle2d Roof(const Building& part) const { return Around(part, 1.0); }
  Vector2d ToEnu(const Vector2d& point) const { return main_.centre + turn_.TurnedDirection(point); }
  Ring ToEnu(Ring ring) const {
    for (Vector2d& point : ring) point = ToEnu(point);
    return ring;
  }

 private:
  Rectangle2d Around(const Building& part, double overhangs) const {
    const Vector2d centre = turn_.TurnedBack(part.centre - main_.centre);
    const auto quarters = static_cast<size_t>(std::lround(std::remainder(part.yaw_deg - main_.yaw_deg, 360.0) / 90.0) + 4) % 4;
    std::array<double, 4> reach{};  // to +x, +y, -x, -y of the outline's axes
    for (size_t side = 0; side < 4; ++side) {
      reach[(side + quarters) % 4] = 0.5 * (side % 2 == 0 ? part.length_m : part.width_m) + overhangs * OverhangAt(part, side);
    }
    return {centre - Vector2d(reach[2], reach[3]), centre + Vector2d(reach[0], reach[1])};
  }
  const Building& main_;
  PlaneTurn turn_;
};

Outline OutlineOf(std::span<const Building> buildings, size_t first, size_t n_parts) {
  Outline outline{.first = first, .n_parts = n_parts, .largest = first, .walls = {}, .holes = {}, .roof = {}};
  const Building& main = buildings[first];
  const OutlineAxes axes(main);
  std::vector<Rectangle2d> walls, roofs;
  for (size_t i = first; i < first + n_parts; ++i) {
    const Building& part = buildings[i];
    walls.push_back(axes.Walls(part));
    roofs.push_back(axes.Roof(part));
    const Building& largest = buildings[outline.largest];
    if (part.length_m * part.width_m > largest.length_m * largest.width_m) outline.largest = i;
  }
  RectangleUnion ground_plan = UnionOf(walls);
  outline.area_m2 = SignedArea(ground_plan.outer);
  for (Ring& hole : ground_plan.holes) {
    outline.area_m2 += SignedArea(hole);
    outline.holes.push_back(axes.ToEnu(std::move(hole)));
  }
  outline.walls = axes.ToEnu(std::move(ground_plan.outer));
  outline.roof = axes.ToEnu(UnionOf(roofs).outer);
  if (n_parts == 1) {
    outline.centre = main.centre;
    outline.length_m = main.length_m;
    outline.width_m = main.width_m;
    outline.yaw_deg = main.yaw_deg;
    return outline;
  }
  Vector2d low = walls[0].min, high = walls[0].max;
  for (const Rectangle2d& one : walls) {
    low = low.cwiseMin(one.min);
    high = high.cwiseMax(one.max);
  }
  const Vector2d size = high - low;
  outline.centre = axes.ToEnu(Vector2d(0.5 * (low + high)));
  outline.length_m = size.maxCoeff();
  outline.width_m = size.minCoeff();
  outline.yaw_deg = size.x() >= size.y() ? main.yaw_deg : std::remainder(main.yaw_deg + 90.0, 360.0);
  return outline;
}

}  // namespace

void NumberOutlines(std::vector<Building>& buildings) {
  uint32_t n = 0;
  for (Building& building : buildings) {
    if (!building.joined) ++n;
    building.outline = n - 1;
  }
}

std::vector<Outline> FindOutlines(std::span<const Building> buildings) {
  std::vector<Outline> outlines;
  for (size_t first = 0; first < buildings.size();) {
    size_t end = first + 1;
    while (end < buildings.size() && buildings[end].outline == buildings[first].outline) ++end;
    outlines.push_back(OutlineOf(buildings, first, end - first));
    first = end;
  }
  return outlines;
}

std::vector<RoofPlane3d> RoofPlanes(const Building& part) {
  const Vector2d u = part.Axis(), v(-u.y(), u.x());
  // The plane that falls towards `fall` and is eave_height_m high this far from the centre.
  const auto Plane = [&part](const Vector2d& fall, double half_m) {
    const double rise = part.RoofRise();
    const Vector3d normal = Vector3d(rise * fall.x(), rise * fall.y(), 1.0).normalized();
    const Vector2d on_wall = part.centre + half_m * fall;
    return RoofPlane3d{normal, normal.dot(Vector3d(on_wall.x(), on_wall.y(), part.ground_z_m + part.eave_height_m))};
  };
  if (part.roof == RoofKind::kFlat) return {{Vector3d::UnitZ(), part.ground_z_m + part.eave_height_m}};
  std::vector<RoofPlane3d> planes = {Plane(v, 0.5 * part.width_m), Plane(-v, 0.5 * part.width_m)};
  if (part.roof == RoofKind::kHip) {
    planes.push_back(Plane(u, 0.5 * part.length_m));
    planes.push_back(Plane(-u, 0.5 * part.length_m));
  }
  return planes;
}

double RoofHeight(const Building& part, const Vector2d& at) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const RoofPlane3d& plane : RoofPlanes(part)) lowest = std::min(lowest, plane.HeightAt(at));
  return lowest;
}

}  // namespace skyquilt::simulate
