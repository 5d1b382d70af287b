#include "tests/buildings/sample_clouds.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>

#include "core/base/random.h"
#include "tests/buildings/sample_buildings.h"

namespace skyquilt::buildings {
namespace {

constexpr std::array<uint8_t, 3> kGrey = {118, 114, 108}, kRed = {150, 92, 78}, kWhite = {205, 200, 190}, kGreen = {70, 110, 50},
                                 kBrown = {105, 92, 80};

struct Box2 {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = Eigen::Vector2d::Constant(-std::numeric_limits<double>::infinity());

  void Add(const Eigen::Vector2d& x) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
};

// One random place in each cell of a grid over a box.
void ForEachPlace(const Box2& box, double cell, base::Random* random, const std::function<void(const Eigen::Vector2d&)>& body) {
  const Eigen::Vector2d size = box.high - box.low;
  const int columns = std::max(1, static_cast<int>(std::lround(size.x() / cell))), rows = std::max(1, static_cast<int>(std::lround(size.y() / cell)));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double x = (column + random->UniformDouble()) / columns;
      const double y = (row + random->UniformDouble()) / rows;
      body(box.low + size.cwiseProduct(Eigen::Vector2d(x, y)));
    }
  }
}

// By the rule of even and odd crossings.
bool Inside(const std::vector<std::vector<Eigen::Vector2d>>& rings, const Eigen::Vector2d& x) {
  bool inside = false;
  for (const auto& ring : rings) {
    for (size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      if ((ring[i].y() > x.y()) == (ring[j].y() > x.y())) continue;
      if (x.x() < ring[j].x() + (ring[i].x() - ring[j].x()) * (x.y() - ring[j].y()) / (ring[i].y() - ring[j].y())) inside = !inside;
    }
  }
  return inside;
}

std::vector<std::vector<Eigen::Vector2d>> RingsOf(const Polygon& polygon) {
  std::vector<std::vector<Eigen::Vector2d>> rings = polygon.holes;
  rings.push_back(polygon.outer);
  return rings;
}

class Sampler {
 public:
  Sampler(const CloudPlan& plan, MadeCloud* made) : plan_(plan), made_(*made), random_(plan.seed) {}

  void AddRoofs(const Building& building) {
    const Shape& shape = building.shape;
    for (size_t i = 0; i < shape.parts.size(); ++i) {
      const RoofBox box = RoofBoxOf(shape, shape.parts[i], building.overhang_m);
      const double slope = SlopeOf(shape, shape.parts[i]);
      // The area of the slope, not that of its plan, gets a point per spacing_m^2.
      const double cell = plan_.spacing_m / std::pow(1.0 + slope * slope, 0.25);
      ForEachPlace({box.low, box.high}, cell, &random_, [&](const Eigen::Vector2d& uv) {
        int highest = -1;
        const double z = MadeRoofHeight(building, uv, &highest);
        if (highest == static_cast<int>(i)) Add(Placed(shape, uv, z), RoofNormal(building, uv), kRed, MadeSurface::kRoof, building.id);
      });
    }
  }

  void AddWalls(const Building& building) {
    const Solid& solid = building.lod22;
    for (const Face& face : solid.face) {
      if (face.kind != FaceKind::kWall) continue;
      Eigen::Vector3d normal = Eigen::Vector3d::Zero();
      const Eigen::Vector3d first = solid.vertex[face.outer[0]];
      for (size_t i = 1; i + 1 < face.outer.size(); ++i)
        normal += (solid.vertex[face.outer[i]] - first).cross(solid.vertex[face.outer[i + 1]] - first);
      normal.normalize();
      const Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(normal);
      Box2 box;
      std::vector<std::vector<Eigen::Vector2d>> rings(1);
      for (const uint32_t i : face.outer) {
        rings[0].emplace_back(right.dot(solid.vertex[i] - first), solid.vertex[i].z() - first.z());
        box.Add(rings[0].back());
      }
      ForEachPlace(box, plan_.spacing_m, &random_, [&](const Eigen::Vector2d& x) {
        if (!Inside(rings, x) || random_.UniformDouble() >= plan_.wall_share) return;
        Add(first + x.x() * right + x.y() * Eigen::Vector3d::UnitZ(), normal, kWhite, MadeSurface::kWall, building.id);
      });
    }
  }

  void AddGround(const std::vector<Building>& buildings) {
    Box2 box;
    for (const Building& building : buildings)
      for (const Eigen::Vector2d& x : building.footprint.outer) box.Add(x);
    box.low -= Eigen::Vector2d::Constant(plan_.ground_margin_m);
    box.high += Eigen::Vector2d::Constant(plan_.ground_margin_m);
    ForEachPlace(box, plan_.spacing_m, &random_, [&](const Eigen::Vector2d& x) {
      for (const Building& building : buildings)
        if (Inside(RingsOf(building.footprint), x)) return;
      Add({x.x(), x.y(), buildings[0].shape.ground_z}, Eigen::Vector3d::UnitZ(), kGrey, MadeSurface::kGround, 0);
    });
  }

  void Add(const Eigen::Vector3d& x, const Eigen::Vector3d& normal, const std::array<uint8_t, 3>& rgb, MadeSurface surface, int id) {
    const Eigen::Vector3d bend = plan_.normal_noise * Eigen::Vector3d{random_.Normal(), random_.Normal(), random_.Normal()};
    const Eigen::Vector3d moved = x + plan_.noise_m * random_.Normal() * normal;
    SurfacePoint point;
    point.position = (moved - made_.cloud.middle).cast<float>();
    point.normal = (normal + bend).normalized().cast<float>();
    point.rgb = rgb;
    point.views = 5;
    made_.cloud.points.push_back(point);
    made_.surface.push_back(surface);
    made_.building.push_back(id);
  }

 private:
  static Eigen::Vector3d Placed(const Shape& shape, const Eigen::Vector2d& uv, double z) {
    const Eigen::Vector2d enu = EnuOf(shape, uv);
    return {enu.x(), enu.y(), z};
  }

  // By differences towards the middle of the roof, so that they stay on it; a place on a ridge gets one of its sides.
  static Eigen::Vector3d RoofNormal(const Building& building, const Eigen::Vector2d& uv) {
    constexpr double kStep_m = 1e-4;
    const double here = MadeRoofHeight(building, uv);
    Eigen::Vector2d slope;
    for (int axis = 0; axis < 2; ++axis) {
      double step = kStep_m;
      double there = MadeRoofHeight(building, uv + step * Eigen::Vector2d::Unit(axis));
      if (std::isnan(there) || std::abs(there - here) > 10.0 * kStep_m) {
        step = -kStep_m;
        there = MadeRoofHeight(building, uv + step * Eigen::Vector2d::Unit(axis));
      }
      slope[axis] = (there - here) / step;
    }
    const Eigen::Vector2d fall = EnuOf(building.shape, slope) - building.shape.origin;
    return Eigen::Vector3d(-fall.x(), -fall.y(), 1.0).normalized();
  }

  const CloudPlan& plan_;
  MadeCloud& made_;
  base::Random random_;
};

}  // namespace

MadeCloud MadeCloudOf(const std::vector<Building>& buildings, const CloudPlan& plan) {
  MadeCloud made;
  made.cloud.spacing_m = plan.spacing_m;
  if (buildings.empty()) return made;
  made.cloud.middle << buildings[0].shape.origin, buildings[0].shape.ground_z;
  Sampler sampler(plan, &made);
  for (const Building& building : buildings) {
    sampler.AddRoofs(building);
    sampler.AddWalls(building);
  }
  sampler.AddGround(buildings);
  return made;
}

void AddTree(MadeCloud* made, const Eigen::Vector3d& middle, double radius_m, bool green, uint64_t seed) {
  CloudPlan plan;
  plan.seed = seed;
  base::Random random(seed, 1);
  Sampler sampler(plan, made);
  const double area_m2 = 4.0 * std::numbers::pi * radius_m * radius_m;
  const auto count = static_cast<int>(area_m2 / (made->cloud.spacing_m * made->cloud.spacing_m));
  const auto direction = [&] { return Eigen::Vector3d{random.Normal(), random.Normal(), random.Normal()}.normalized(); };
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d out = direction();
    const Eigen::Vector3d x = middle + radius_m * random.Uniform(0.7, 1.0) * out;
    sampler.Add(x, (out + 1.2 * direction()).normalized(), green ? kGreen : kBrown, MadeSurface::kTree, 0);
  }
}

}  // namespace skyquilt::buildings
