#include "tests/buildings/fit/made_surface.h"

#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

#include "buildings/fit/wall_groups.h"
#include "buildings/fit/wall_strips.h"
#include "core/base/random.h"

namespace skyquilt::buildings {
namespace {

constexpr int kRoofViews = 20;

// A smooth random function of two coordinates (random Fourier features): Gaussian, of correlation exp(-h^2 / (2 length^2)).
class Waves {
 public:
  Waves(double size_m, double length_m, base::Random* random) : size_m_(size_m) {
    for (int i = 0; i < kTerms; ++i)
      terms_.push_back({random->Normal() / length_m, random->Normal() / length_m, random->Uniform(0, 2 * std::numbers::pi)});
  }
  double At(double x, double y) const {
    double sum = 0.0;
    for (const auto& [a, b, phase] : terms_) sum += std::cos(a * x + b * y + phase);
    return size_m_ * std::sqrt(2.0 / kTerms) * sum;
  }

 private:
  static constexpr int kTerms = 60;
  double size_m_;
  std::vector<std::tuple<double, double, double>> terms_;
};

class SurfaceMaker {
 public:
  SurfaceMaker(const Shape& shape, const SurfacePlan& plan) : shape_(shape), plan_(plan), random_(plan.seed) {
    made_.cloud.middle = {shape.origin.x(), shape.origin.y(), 0.0};
    made_.cloud.spacing_m = plan.spacing_m;
  }

  MadeSurface Make() {
    AddRoofs();
    if (plan_.walls) AddWalls();
    AddGround();
    return std::move(made_);
  }

 private:
  double Noise(const std::tuple<int, int, int, int>& surface, double x, double y) {
    double noise = plan_.noise_m * random_.Normal();
    if (plan_.waves_m > 0.0) {
      const auto [place, is_new] = waves_.try_emplace(surface, plan_.waves_m, plan_.wave_length_m, &random_);
      noise += place->second.At(x, y);
    }
    return noise;
  }
  void Add(const Eigen::Vector2d& uv, double z, const Eigen::Vector3d& normal_uvz, int views, std::vector<uint32_t>* list) {
    const Eigen::Vector2d enu = shape_.EnuFrom(uv) - shape_.origin;
    const Eigen::Vector2d flat = normal_uvz.x() * shape_.AxisU() + normal_uvz.y() * shape_.AxisV();
    SurfacePoint point;
    point.position = Eigen::Vector3d(enu.x(), enu.y(), z).cast<float>();
    point.normal = Eigen::Vector3d(flat.x(), flat.y(), normal_uvz.z()).normalized().cast<float>();
    point.rgb = {120, 120, 120};
    point.views = static_cast<uint8_t>(views);
    list->push_back(static_cast<uint32_t>(made_.cloud.points.size()));
    made_.cloud.points.push_back(point);
  }

  double RoofAt(const Eigen::Vector2d& uv, int* part) const {
    *part = -1;
    double top = kUnknown;
    for (size_t p = 0; p < shape_.parts.size(); ++p) {
      const double over = IsPitched(shape_.parts[p]) ? plan_.overhang_m : 0.0;
      const Eigen::Vector2d low = shape_.MinOf(shape_.parts[p], true), high = shape_.MaxOf(shape_.parts[p], true);
      if (((low - uv).array() > over).any() || ((uv - high).array() > over).any()) continue;
      const double z = RoofHeight(shape_, shape_.parts[p], uv);
      if (*part < 0 || z > top) {
        top = z;
        *part = static_cast<int>(p);
      }
    }
    return top;
  }
  void AddRoofs() {
    const double margin = plan_.overhang_m + 0.5;
    for (double u = shape_.u.front() - margin; u < shape_.u.back() + margin; u += plan_.spacing_m) {
      for (double v = shape_.v.front() - margin; v < shape_.v.back() + margin; v += plan_.spacing_m) {
        const double off_v = random_.Uniform(-1, 1), off_u = random_.Uniform(-1, 1);
        const Eigen::Vector2d uv = Eigen::Vector2d(u, v) + 0.2 * plan_.spacing_m * Eigen::Vector2d(off_u, off_v);
        int part = -1, other = -1;
        double z = RoofAt(uv, &part);
        if (part < 0) continue;
        const double h = 1e-4;
        const double du = RoofAt(uv + Eigen::Vector2d(h, 0), &other) - z, dv = RoofAt(uv + Eigen::Vector2d(0, h), &other) - z;
        Eigen::Vector3d normal(std::isfinite(du) ? -du / h : 0.0, std::isfinite(dv) ? -dv / h : 0.0, 1.0);
        if (normal.head<2>().norm() > 3.0) normal = Eigen::Vector3d::UnitZ();  // across a step
        const int facet = std::abs(normal.x()) > std::abs(normal.y()) ? (normal.x() > 0 ? 1 : 2) : normal.y() > 0 ? 3 : normal.y() < 0 ? 4 : 0;
        z += Noise({0, part, facet, 0}, uv.x(), uv.y()) * normal.norm();
        if (plan_.parapet_m > 0.0 && !IsPitched(shape_.parts[static_cast<size_t>(part)]) && NearRim(uv, part)) z += plan_.parapet_m;
        Add(uv, z, normal, kRoofViews, &made_.candidate.roof);
      }
    }
  }
  bool NearRim(const Eigen::Vector2d& uv, int part) const {
    for (const double step : {-0.25, 0.25}) {
      for (const int axis : {0, 1}) {
        int there = -1;
        RoofAt(uv + step * Eigen::Vector2d::Unit(axis), &there);
        if (there != part) return true;
      }
    }
    return false;
  }

  // From the rim, 4 GSD down its side, back to the wall 15 GSD below it, and down.
  void AddWalls() {
    const double gsd = plan_.gsd_m;
    const double set_back = SetBack_gsd(plan_.wall_views, kRoofViews) * gsd;
    for (const auto& [key, strip] : StripsOf(shape_, 1.0)) {
      const Rim rim = RimOf(strip.pitched, strip.sloped);
      for (const WallPiece& piece : strip.pieces) {
        for (double along = piece.from + 0.5 * plan_.spacing_m; along < piece.to; along += plan_.spacing_m) {
          const WallHeights heights = HeightsAt(shape_, piece, along);
          const double top = heights.top - (strip.sloped ? strip.rise * plan_.overhang_m : 0.0);
          for (double below = strip.pitched ? 0.0 : -plan_.parapet_m; top - below > heights.bottom; below += plan_.spacing_m) {
            const double b = below / gsd;
            const double reach = strip.pitched && !plan_.under ? plan_.overhang_m * std::clamp((15.0 - b) / 11.0, 0.0, 1.0) : 0.0;
            const bool is_rim = !plan_.under && b >= rim.from_gsd && b <= rim.to_gsd;
            const double out = (is_rim ? (strip.pitched ? plan_.overhang_m : 0.0) + rim.off_gsd * gsd : reach - set_back) +
                               Noise({1 + key.axis, key.line, key.side, is_rim}, along, below);
            Eigen::Vector2d uv;
            uv[piece.axis] = (piece.axis == 0 ? shape_.u : shape_.v)[static_cast<size_t>(piece.line)] + piece.side * out;
            uv[1 - piece.axis] = along;
            Eigen::Vector3d normal = Eigen::Vector3d::Zero();
            normal[piece.axis] = piece.side;
            Add(uv, top - below, normal, plan_.wall_views, &made_.candidate.wall);
          }
        }
      }
    }
  }

  void AddGround() {
    for (double u = shape_.u.front() - 3.0; u < shape_.u.back() + 3.0; u += 2.0 * plan_.spacing_m) {
      for (double v = shape_.v.front() - 3.0; v < shape_.v.back() + 3.0; v += 2.0 * plan_.spacing_m) {
        int part = -1;
        RoofAt({u, v}, &part);
        if (part < 0) Add({u, v}, shape_.ground_z + Noise({9, 0, 0, 0}, u, v), Eigen::Vector3d::UnitZ(), kRoofViews, &made_.candidate.ground);
      }
    }
  }

  const Shape& shape_;
  const SurfacePlan& plan_;
  base::Random random_;
  std::map<std::tuple<int, int, int, int>, Waves> waves_;
  MadeSurface made_;
};

}  // namespace

MadeSurface SurfaceOf(const Shape& shape, const SurfacePlan& plan) {
  return SurfaceMaker(shape, plan).Make();
}

Shape OnePart(RoofKind roof, double length, double width, double eave_z, double ridge_z, double yaw_rad) {
  Shape shape;
  shape.origin = {30.0, -20.0};
  shape.yaw_rad = yaw_rad;
  shape.u = {-0.5 * length, 0.5 * length};
  shape.v = {-0.5 * width, 0.5 * width};
  shape.ground_z = eave_z - 6.0;
  Part part;
  part.roof = roof;
  part.along_u = length >= width;
  part.eave_z = eave_z;
  part.ridge_z = ridge_z;
  shape.parts = {part};
  return shape;
}

Shape Disturbed(const Shape& shape, double line_m, double height_m, double yaw_rad, uint64_t seed) {
  base::Random random(seed, 3);
  Shape guess = shape;
  guess.yaw_rad += random.Uniform(-yaw_rad, yaw_rad);
  for (std::vector<double>* lines : {&guess.u, &guess.v}) {
    for (double& line : *lines) line += random.Uniform(-line_m, line_m);
  }
  for (Part& part : guess.parts) {
    part.eave_z += random.Uniform(-height_m, height_m);
    part.ridge_z = IsPitched(part) ? part.ridge_z + random.Uniform(-height_m, height_m) : part.eave_z;
  }
  return guess;
}

}  // namespace skyquilt::buildings
