#include "simulate/object_material.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "simulate/noise.h"

namespace skyquilt::simulate {

using Eigen::Vector3f;

Surface TreeSurface(const Tree& tree, const Hit& hit) {
  Surface surface;
  surface.normal = hit.normal;
  const float w = SurfaceFootprint(hit);
  const Vector3f& p = hit.position;
  if (hit.tag.part == Part::kTrunk) {
    surface.albedo = Vector3f(0.11F, 0.085F, 0.06F);
    return surface;
  }
  const float hue = HashUnit(1, 1, tree.seed);
  const Vector3f fresh(0.085F, 0.125F, 0.030F);
  const Vector3f dark(0.038F, 0.078F, 0.028F);
  Vector3f color = tree.conifer ? Vector3f(0.030F, 0.055F, 0.026F) : Vector3f(fresh + hue * (dark - fresh));
  if (!tree.conifer && HashUnit(2, 2, tree.seed) > 0.96F) color = Vector3f(0.10F, 0.045F, 0.035F);
  // Leaf clusters: the sum of two slanted 2D noises replaces 3D noise.
  const float clusters = FractalNoise(p.x() + 0.6F * p.z(), p.y() - 0.5F * p.z(), {1.9F, 3, 0.6F}, tree.seed + 5U, w) +
                         0.5F * FractalNoise(p.x() - 0.7F * p.z(), p.y() + 0.8F * p.z(), {1.3F, 2, 0.6F}, tree.seed + 15U, w);
  surface.albedo = color * std::max(1.0F + 0.36F * clusters, 0.3F);
  return surface;
}

Surface CarSurface(const Car& car, const Hit& hit) {
  constexpr std::array<std::array<float, 3>, 8> kPaint = {{{0.62F, 0.62F, 0.62F},
                                                           {0.030F, 0.030F, 0.034F},
                                                           {0.30F, 0.31F, 0.32F},
                                                           {0.36F, 0.025F, 0.022F},
                                                           {0.035F, 0.075F, 0.22F},
                                                           {0.12F, 0.12F, 0.125F},
                                                           {0.48F, 0.46F, 0.42F},
                                                           {0.055F, 0.13F, 0.075F}}};
  Surface surface;
  surface.normal = hit.normal;
  surface.mirror_normal = hit.normal;
  surface.mirror = 0.04F;
  if (hit.tag.part == Part::kCarTyre) {
    surface.albedo = Vector3f::Constant(0.02F);
    surface.mirror = 0.0F;
  } else if (hit.tag.part == Part::kCarGlass) {
    surface.albedo = Vector3f(0.020F, 0.024F, 0.028F);
  } else {
    const auto& paint = kPaint[HashCell(3, 3, car.seed) % kPaint.size()];
    surface.albedo = Vector3f(paint[0], paint[1], paint[2]);
    if (car.kind != CarKind::kCar) {
      // Ribs across the body, and dust.
      const float w = SurfaceFootprint(hit);
      const auto yaw = static_cast<float>(car.yaw_deg * std::numbers::pi / 180.0);
      const float along = std::cos(yaw) * hit.position.x() + std::sin(yaw) * hit.position.y();
      const float dust = 0.5F + FractalNoise(hit.position.x() + hit.position.z(), hit.position.y() - hit.position.z(), {2.5F, 3, 0.5F}, car.seed, w);
      surface.albedo *= 1.0F - 0.25F * PulseTrain(along / 0.6F, 0.3F, w / 0.6F);
      surface.albedo += 0.15F * std::clamp(dust, 0.0F, 1.0F) * (Vector3f(0.24F, 0.22F, 0.19F) - surface.albedo);
    }
  }
  return surface;
}

}  // namespace skyquilt::simulate
