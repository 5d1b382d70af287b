#include "simulate/tidal_material.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "simulate/ground_material.h"
#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3f;

Vector3f DrySand(float x, float y, float w, uint32_t seed) {
  const float tone =
      1.0F + 0.14F * FractalNoise(x, y, {26.0F, 3, 0.5F}, seed + 100U, w) + 0.12F * FractalNoise(x, y, {3.1F, 3, 0.6F}, seed + 200U, w);
  Vector3f sand = Vector3f(0.250F, 0.208F, 0.155F) * tone;
  // Films of algae and beds of shells.
  const float algae = Smoothstep(0.30F, 1.0F, FractalNoise(x, y, {38.0F, 4, 0.55F}, seed + 300U, w));
  const float shells = Smoothstep(0.60F, 1.2F, FractalNoise(x, y, {14.0F, 4, 0.6F}, seed + 400U, w));
  sand += 0.65F * algae * (Vector3f(0.080F, 0.092F, 0.034F) * tone - sand);
  sand += 0.45F * shells * (Vector3f(0.34F, 0.32F, 0.295F) * tone - sand);
  return sand;
}

}  // namespace

Surface TidalSand(const Hit& hit, float water_z_m, uint32_t seed) {
  const float x = hit.position.x();
  const float y = hit.position.y();
  const float w = SurfaceFootprint(hit);
  Surface surface;
  surface.normal = hit.normal;
  const float above = hit.position.z() - water_z_m;
  const float damp = FractalNoise(x, y, {24.0F, 4, 0.5F}, seed + 500U, w);
  // Films of standing water in hollows and along channels, with wet sand around them.
  const float low_lying = damp - 1.1F * (above - 0.42F);
  const float film = Smoothstep(0.32F, 0.62F, low_lying);
  const float wet = Smoothstep(-0.35F, 0.40F, low_lying);
  surface.albedo = DrySand(x, y, w, seed) * (1.0F - 0.45F * wet - 0.22F * film);
  // Ripples: curved rows 0.9 m apart, not under water films or where they are smaller than a pixel.
  constexpr float kRipple = 0.9F;
  const float visible = std::clamp(kRipple / (3.0F * w) - 0.6F, 0.0F, 1.0F) * (1.0F - film);
  if (visible > 0.0F) {
    const float field = Smoothstep(-0.4F, 0.4F, FractalNoise(x, y, {30.0F, 2, 0.5F}, seed + 700U, w));
    const float bend = 1.9F * FractalNoise(x, y, {16.0F, 2, 0.45F}, seed + 800U, 0.0F);
    const float phase = 6.2831853F / kRipple * (0.86F * x + 0.5F * y + bend);
    const float slope = 0.13F * visible * field * std::cos(phase);
    surface.normal = (hit.normal + Vector3f(-0.86F * slope, -0.5F * slope, 0.0F)).normalized();
    surface.albedo *= 1.0F - 0.08F * visible * field * std::sin(phase);
  }
  if (film <= 0.0F) return surface;
  // Silt makes the film a better mirror than clear water.
  surface.mirror = 0.14F;
  surface.mirror_share = film;
  surface.mirror_normal = WaveNormal(x, y, 5.0F, 0.004F, w, seed + 850U);
  return surface;
}

Surface TidalWater(const Terrain& bed, const Hit& hit, uint32_t seed) {
  const float x = hit.position.x();
  const float y = hit.position.y();
  const float w = SurfaceFootprint(hit);
  const float depth = std::max(hit.position.z() - bed.Height(x, y), 0.0F);
  const Vector3f sand = depth < 1.5F ? Vector3f(0.5F * DrySand(x, y, w, seed)) : Vector3f(0.12F, 0.10F, 0.075F);
  const Vector3f through = Vector3f(-2.6F * depth, -1.6F * depth, -1.9F * depth).array().exp();
  Surface surface;
  surface.albedo = sand.cwiseProduct(through) + Vector3f(0.040F, 0.060F, 0.052F).cwiseProduct(Vector3f::Ones() - through);
  surface.mirror = 0.05F;
  surface.mirror_normal = WaveNormal(x, y, 1.8F, 0.022F, w, seed + 870U);
  return surface;
}

}  // namespace skyquilt::simulate
