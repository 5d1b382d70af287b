#include "tests/buildings/shape/made_candidates.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include "core/base/random.h"

namespace skyquilt::buildings {
namespace {

constexpr double kSpacing_m = 0.28;
constexpr double kOutlineCell_m = 0.4;

// Collects points with noise; the outline follows the cells of a raster along east and north, as that of real candidates.
class Maker {
 public:
  Maker(const MadePlan& plan, const Eigen::Vector2d& middle) : plan_(plan), random_(plan.seed) {
    made_.cloud.middle = {middle.x(), middle.y(), 100.0};
    made_.cloud.spacing_m = kSpacing_m;
  }

  base::Random& random() { return random_; }

  uint32_t Add(const Eigen::Vector3d& at, const Eigen::Vector3d& normal) {
    const Eigen::Vector3d moved = at + plan_.noise_m * random_.Normal() * normal;
    const Eigen::Vector3d turned = normal + plan_.normal_noise * Eigen::Vector3d{random_.Normal(), random_.Normal(), random_.Normal()};
    SurfacePoint point;
    point.position = (moved - made_.cloud.middle).cast<float>();
    point.normal = turned.normalized().cast<float>();
    point.rgb = {150, 140, 130};
    point.views = 5;
    made_.cloud.points.push_back(point);
    return static_cast<uint32_t>(made_.cloud.points.size() - 1);
  }
  void AddRoof(const Eigen::Vector3d& at, const Eigen::Vector3d& normal, int plane) {
    const uint32_t point = Add(at, normal);
    made_.candidate.roof.push_back(point);
    RoofPlane& of = planes_[plane];
    of.points.push_back(point);
    of.normal = normal;
  }
  void AddWall(const Eigen::Vector3d& at, const Eigen::Vector3d& normal, bool outer) {
    if (random_.UniformDouble() > plan_.wall_share) return;
    (outer ? made_.candidate.wall : made_.candidate.roof).push_back(Add(at, normal));
  }

  MadeCandidate Finish(double half_m, const std::function<bool(const Eigen::Vector2d& enu)>& is_covered) {
    const int n = static_cast<int>(2.0 * half_m / kOutlineCell_m) + 2;
    const Eigen::Vector2d origin = made_.cloud.middle.head<2>() - Eigen::Vector2d::Constant(half_m);
    std::vector<uint8_t> mask(static_cast<size_t>(n) * static_cast<size_t>(n));
    for (int row = 0; row < n; ++row) {
      for (int column = 0; column < n; ++column) {
        const Eigen::Vector2d enu = origin + kOutlineCell_m * Eigen::Vector2d(column + 0.5, row + 0.5);
        mask[static_cast<size_t>(row * n + column)] = is_covered(enu) ? 1 : 0;
      }
    }
    made_.candidate.outline = OutlinesOf(mask, n, n, origin, kOutlineCell_m).at(0);
    for (auto& [key, plane] : planes_) {
      plane.middle = Eigen::Vector3d::Zero();
      for (const uint32_t i : plane.points) plane.middle += made_.cloud.At(i) / static_cast<double>(plane.points.size());
      const Eigen::Vector3d tilt{random_.Normal(), random_.Normal(), 0.0};
      plane.normal = (plane.normal + 0.01 * tilt).normalized();
      plane.rms_m = plan_.noise_m;
      plane.area_m2 = static_cast<double>(plane.points.size()) * kSpacing_m * kSpacing_m;
      made_.candidate.planes.push_back(plane);
    }
    std::stable_sort(made_.candidate.planes.begin(), made_.candidate.planes.end(),
                     [](const RoofPlane& a, const RoofPlane& b) { return a.area_m2 > b.area_m2; });
    return std::move(made_);
  }

 private:
  const MadePlan& plan_;
  base::Random random_;
  MadeCandidate made_;
  std::map<int, RoofPlane> planes_;
};

// Highest roof at a place; pitched roofs reach over their walls.
struct Top {
  double z = kUnknown;
  int part = -1;
};
Top TopAt(const Shape& shape, const Eigen::Vector2d& uv, double overhang_m) {
  Top top;
  for (size_t i = 0; i < shape.parts.size(); ++i) {
    const Part& part = shape.parts[i];
    const Eigen::Vector2d over = Eigen::Vector2d::Constant(part.roof == RoofKind::kFlat ? 0.0 : overhang_m);
    const Eigen::Vector2d low = shape.MinOf(part, true) - over, high = shape.MaxOf(part, true) + over;
    if ((uv.array() < low.array()).any() || (uv.array() > high.array()).any()) continue;
    const double z = RoofHeight(shape, part, uv);
    if (!(z <= top.z)) top = {z, static_cast<int>(i)};
  }
  return top;
}

Eigen::Vector3d InEnu(const Shape& shape, const Eigen::Vector2d& uv, double z) {
  const Eigen::Vector2d enu = shape.EnuFrom(uv);
  return {enu.x(), enu.y(), z};
}

void AddRoofs(const Shape& shape, double overhang_m, Maker* maker) {
  for (double v = shape.v.front() - 1.0; v < shape.v.back() + 1.0; v += kSpacing_m) {
    for (double u = shape.u.front() - 1.0; u < shape.u.back() + 1.0; u += kSpacing_m) {
      const Eigen::Vector2d uv(u + kSpacing_m * maker->random().UniformDouble(), v + kSpacing_m * maker->random().UniformDouble());
      const Top top = TopAt(shape, uv, overhang_m);
      if (top.part < 0) continue;
      const Part& part = shape.parts[static_cast<size_t>(top.part)];
      const double du = (RoofHeight(shape, part, uv + Eigen::Vector2d(1e-4, 0)) - RoofHeight(shape, part, uv - Eigen::Vector2d(1e-4, 0))) / 2e-4;
      const double dv = (RoofHeight(shape, part, uv + Eigen::Vector2d(0, 1e-4)) - RoofHeight(shape, part, uv - Eigen::Vector2d(0, 1e-4))) / 2e-4;
      const Eigen::Vector2d slope = du * shape.AxisU() + dv * shape.AxisV();
      const int facing = (du > 0.05 ? 1 : du < -0.05 ? 2 : 0) + 3 * (dv > 0.05 ? 1 : dv < -0.05 ? 2 : 0);
      maker->AddRoof(InEnu(shape, uv, top.z), Eigen::Vector3d(-slope.x(), -slope.y(), 1.0).normalized(), 9 * top.part + facing);
    }
  }
}

void AddWalls(const Shape& shape, Maker* maker) {
  for (const Part& part : shape.parts) {
    const Eigen::Vector2d low = shape.MinOf(part, false), high = shape.MaxOf(part, false);
    for (const int axis : {0, 1}) {
      for (const int side : {-1, 1}) {
        Eigen::Vector2d outward = Eigen::Vector2d::Zero();
        outward[axis] = side;
        const Eigen::Vector2d normal = outward.x() * shape.AxisU() + outward.y() * shape.AxisV();
        for (double along = low[1 - axis]; along < high[1 - axis]; along += kSpacing_m) {
          Eigen::Vector2d uv;
          uv[axis] = side > 0 ? high[axis] : low[axis];
          uv[1 - axis] = along;
          const Top inside = TopAt(shape, uv - 0.01 * outward, 0.0), outside = TopAt(shape, uv + 0.01 * outward, 0.0);
          if (inside.part < 0) continue;
          const bool outer = outside.part < 0;
          for (double z = outer ? shape.ground_z + 0.5 : outside.z; z < inside.z - 0.2; z += kSpacing_m) {
            maker->AddWall(InEnu(shape, uv, z), {normal.x(), normal.y(), 0.0}, outer);
          }
        }
      }
    }
  }
}

}  // namespace

MadeCandidate MakeCandidate(const Shape& shape, const MadePlan& plan, const std::vector<Part>& boxes) {
  Shape all = shape;
  all.parts.insert(all.parts.end(), boxes.begin(), boxes.end());
  Maker maker(plan, all.origin);
  AddRoofs(all, plan.overhang_m, &maker);
  AddWalls(all, &maker);
  double half = 2.0;
  for (const double u : {all.u.front(), all.u.back()}) {
    for (const double v : {all.v.front(), all.v.back()}) half = std::max(half, std::hypot(u, v) + 2.0);
  }
  return maker.Finish(half, [&](const Eigen::Vector2d& enu) { return TopAt(all, all.FromEnu(enu), plan.overhang_m).part >= 0; });
}

MadeCandidate MakeRoundCandidate(double radius_m, double height_m, const MadePlan& plan) {
  const Eigen::Vector2d middle(40.0, -20.0);
  Maker maker(plan, middle);
  for (double x = -radius_m; x < radius_m; x += kSpacing_m) {
    for (double y = -radius_m; y < radius_m; y += kSpacing_m) {
      const Eigen::Vector2d at(x + kSpacing_m * maker.random().UniformDouble(), y + kSpacing_m * maker.random().UniformDouble());
      if (at.norm() < radius_m) maker.AddRoof({middle.x() + at.x(), middle.y() + at.y(), 100.0 + height_m}, Eigen::Vector3d::UnitZ(), 0);
    }
  }
  for (double angle = 0.0; angle < 2.0 * std::numbers::pi; angle += kSpacing_m / radius_m) {
    const Eigen::Vector2d out(std::cos(angle), std::sin(angle));
    const Eigen::Vector2d at = middle + radius_m * out;
    for (double z = 0.5; z < height_m; z += kSpacing_m) maker.AddWall({at.x(), at.y(), 100.0 + z}, {out.x(), out.y(), 0.0}, true);
  }
  return maker.Finish(radius_m + 2.0, [&](const Eigen::Vector2d& enu) { return (enu - middle).norm() < radius_m; });
}

Shape AxesAt(double yaw_deg, std::vector<double> u, std::vector<double> v) {
  Shape shape;
  shape.origin = {300.0, -120.0};
  shape.yaw_rad = yaw_deg * std::numbers::pi / 180.0;
  shape.u = std::move(u);
  shape.v = std::move(v);
  shape.ground_z = 100.0;
  return shape;
}

Part FlatPart(int u0, int u1, int v0, int v1, double z) {
  Part part;
  part.u0 = u0;
  part.u1 = u1;
  part.v0 = v0;
  part.v1 = v1;
  part.eave_z = part.ridge_z = z;
  return part;
}

Part PitchedPart(RoofKind roof, int u0, int u1, int v0, int v1, bool along_u, double eave_z, double ridge_z, int joins) {
  Part part = FlatPart(u0, u1, v0, v1, eave_z);
  part.roof = roof;
  part.along_u = along_u;
  part.ridge_z = ridge_z;
  part.joins = joins;
  return part;
}

double OverlapOf(const Shape& a, const Shape& b) {
  double reach = 0.0;
  for (const Shape* shape : {&a, &b}) {
    for (const double u : {shape->u.front(), shape->u.back()}) {
      for (const double v : {shape->v.front(), shape->v.back()}) reach = std::max(reach, (shape->EnuFrom({u, v}) - b.origin).cwiseAbs().maxCoeff());
    }
  }
  int64_t either = 0, both = 0;
  for (double x = -reach; x <= reach; x += 0.2) {
    for (double y = -reach; y <= reach; y += 0.2) {
      const Eigen::Vector2d enu = b.origin + Eigen::Vector2d(x, y);
      const bool in_a = TopAt(a, a.FromEnu(enu), 0.0).part >= 0, in_b = TopAt(b, b.FromEnu(enu), 0.0).part >= 0;
      either += in_a || in_b ? 1 : 0;
      both += in_a && in_b ? 1 : 0;
    }
  }
  return either > 0 ? static_cast<double>(both) / static_cast<double>(either) : 0.0;
}

}  // namespace skyquilt::buildings
