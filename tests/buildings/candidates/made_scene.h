// Scenes as a surface fused from photos has them: one sheet over the ground, buildings and crowns of trees, with walls below edges of roofs, and
// noise.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "buildings/geometry/polygon.h"
#include "buildings/points/surface_points.h"
#include "core/base/random.h"

namespace skyquilt::buildings {

using Color = std::array<uint8_t, 3>;
inline constexpr Color kGreyGround{120, 118, 115}, kLawn{95, 125, 70}, kRedTiles{150, 85, 65}, kLeaves{60, 100, 45}, kConcrete{180, 180, 175};

class MadeScene {
 public:
  static constexpr double kGround = 40.0, kGsd_m = 0.15, kSpacing_m = 0.22;

  explicit MadeScene(double half_m = 20.0, Color ground = kGreyGround) : half_m_(half_m), ground_color_(ground) {}

  // Bare ground that is not level: height above kGround, not below 0.
  void SetTerrain(std::function<double(const Eigen::Vector2d&)> terrain) { terrain_ = std::move(terrain); }

  // Something that stands on the ground: its top above kGround at a place, 0 beside it; walls below its border when it has an outline.
  struct Thing {
    std::function<double(const Eigen::Vector2d&)> height;
    Color color;
    std::vector<Polygon> walls;
    double bumps_m = 0.0;
  };
  void Add(Thing thing) { things_.push_back(std::move(thing)); }

  static Rectangle At(double east, double north, double length, double width, double yaw_deg = 0.0) {
    Rectangle rectangle;
    rectangle.centre = {east, north};
    rectangle.axis = {std::cos(yaw_deg * std::numbers::pi / 180.0), std::sin(yaw_deg * std::numbers::pi / 180.0)};
    rectangle.half = {0.5 * length, 0.5 * width};
    return rectangle;
  }
  void AddBox(const Rectangle& box, double height, Color color = kConcrete) {
    const Polygon outline = box.Outline();
    Add({[=](const Eigen::Vector2d& at) { return Contains(outline, at) ? height : 0.0; }, color, {outline}});
  }
  // The ridge along the axis; `roof` is the outline of the roof.
  void AddGable(const Rectangle& roof, double eave, double pitch_deg, Color color = kRedTiles) {
    const Eigen::Vector2d across(-roof.axis.y(), roof.axis.x());
    const double slope = std::tan(pitch_deg * std::numbers::pi / 180.0);
    const Polygon outline = roof.Outline();
    Add({[=](const Eigen::Vector2d& at) {
           return Contains(outline, at) ? eave + slope * (roof.half.y() - std::abs((at - roof.centre).dot(across))) : 0.0;
         },
         color,
         {outline}});
  }
  // A round crown, bumpy as leaves are; fields of few photos make it smoother.
  void AddTree(const Eigen::Vector2d& middle, double radius, double height, Color color = kLeaves, double bumps_m = 0.35) {
    Add({[=](const Eigen::Vector2d& at) {
           const double r = (at - middle).norm() / radius;
           return r < 1.0 ? std::max(0.0, height - radius + radius * std::sqrt(1.0 - r * r)) : 0.0;
         },
         color,
         {},
         bumps_m});
  }

  // Height of the surface above the ground.
  double HeightAt(const Eigen::Vector2d& at, const Thing** top = nullptr) const {
    double highest = TerrainAt(at);
    for (const Thing& thing : things_) {
      double height = thing.height(at);
      if (height > 0.0 && thing.bumps_m > 0.0) height += thing.bumps_m * std::sin(4.1 * at.x() + std::sin(2.3 * at.y())) * std::sin(3.7 * at.y());
      if (height <= highest) continue;
      highest = height;
      if (top != nullptr) *top = &thing;
    }
    return highest;
  }

  PointCloud Cloud(double noise_m = 0.04, uint64_t seed = 1) const {
    base::Random random(seed);
    PointCloud cloud;
    cloud.middle = {0.0, 0.0, kGround};
    cloud.spacing_m = kSpacing_m;
    const auto add = [&](const Eigen::Vector3d& at, const Eigen::Vector3d& normal, Color color) {
      const double z = random.Normal(), y = random.Normal(), x = random.Normal();
      const Eigen::Vector3d noisy = normal + 0.1 * Eigen::Vector3d(x, y, z);
      for (uint8_t& part : color) part = static_cast<uint8_t>(part + random.Uniform(-6, 6));
      cloud.points.push_back({(at + noise_m * random.Normal() * normal).cast<float>(), noisy.normalized().cast<float>(), color, 6, 0});
    };
    const auto jitter = [&] { return kSpacing_m * random.Uniform(-0.3, 0.3); };
    for (double x = -half_m_; x < half_m_; x += kSpacing_m) {
      for (double y = -half_m_; y < half_m_; y += kSpacing_m) {
        const Eigen::Vector2d at(x + jitter(), y + jitter());
        const Thing* top = nullptr;
        const double height = HeightAt(at, &top);
        const double step = 0.05;
        const Eigen::Vector2d slope((HeightAt(at + Eigen::Vector2d(step, 0)) - height) / step,
                                    (HeightAt(at + Eigen::Vector2d(0, step)) - height) / step);
        const bool edge = slope.norm() > 3.0;  // beside a jump
        const Eigen::Vector3d normal = edge ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d(-slope.x(), -slope.y(), 1.0).normalized();
        add({at.x(), at.y(), height}, normal, top != nullptr ? top->color : ground_color_);
      }
    }
    for (const Thing& thing : things_) {
      for (const Polygon& outline : thing.walls) {
        AddWall(thing, outline.outer, add, jitter);
        for (const std::vector<Eigen::Vector2d>& hole : outline.holes) AddWall(thing, hole, add, jitter);
      }
    }
    return cloud;
  }
  GroundGrid Ground() const {
    const int n = 1 + static_cast<int>(2.0 * half_m_);
    std::vector<float> height_z;
    for (int row = 0; row < n; ++row) {
      for (int column = 0; column < n; ++column) height_z.push_back(static_cast<float>(kGround + TerrainAt({column - half_m_, row - half_m_})));
    }
    return {Eigen::Vector2d::Constant(-half_m_), 1.0, n, n, std::move(height_z)};
  }

  double TerrainAt(const Eigen::Vector2d& at) const { return terrain_ ? terrain_(at) : 0.0; }

 private:
  // Outlines have the building on their left.
  template <typename AddPoint, typename Jitter>
  void AddWall(const Thing& thing, const std::vector<Eigen::Vector2d>& ring, const AddPoint& add, const Jitter& jitter) const {
    for (size_t i = 0; i < ring.size(); ++i) {
      const Eigen::Vector2d from = ring[i], along = (ring[(i + 1) % ring.size()] - from);
      const Eigen::Vector2d out = Eigen::Vector2d(along.y(), -along.x()).normalized();
      for (double s = 0.5 * kSpacing_m; s < along.norm(); s += kSpacing_m) {
        const Eigen::Vector2d at = from + s * along.normalized();
        const double top = HeightAt(at - 0.02 * out), low = HeightAt(at + 0.02 * out);
        for (double z = low + 0.5 * kSpacing_m; z < top; z += kSpacing_m) {
          const Eigen::Vector2d place = at + jitter() * along.normalized();
          add({place.x(), place.y(), z + jitter()}, {out.x(), out.y(), 0.0}, thing.color);
        }
      }
    }
  }

  double half_m_;
  std::function<double(const Eigen::Vector2d&)> terrain_;
  Color ground_color_;
  std::vector<Thing> things_;
};

}  // namespace skyquilt::buildings
