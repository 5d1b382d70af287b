#include "coordinator/simulate/tidal_material.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "coordinator/simulate/ground_material.h"
#include "coordinator/simulate/noise.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3f;

Vector3f DrySand(float x, float y, float w, uint32_t seed) {
  const float tone =
      1.0F + 0.11F * FractalNoise(x, y, {26.0F, 4, 0.5F}, seed + 100U, w) + 0.08F * FractalNoise(x, y, {2.7F, 3, 0.6F}, seed + 200U, w);
  Vector3f sand = Vector3f(0.44F, 0.375F, 0.285F) * tone;
  // Films of algae and beds of shells.
  const float algae = Smoothstep(0.35F, 1.0F, FractalNoise(x, y, {38.0F, 5, 0.55F}, seed + 300U, w));
  const float shells = Smoothstep(0.65F, 1.1F, FractalNoise(x, y, {14.0F, 5, 0.6F}, seed + 400U, w));
  sand += 0.6F * algae * (Vector3f(0.16F, 0.17F, 0.075F) - sand);
  sand += 0.4F * shells * (Vector3f(0.52F, 0.50F, 0.47F) - sand);
  return sand;
}

}  // namespace

Surface TidalSand(const Hit& hit, float water_z_m, uint32_t seed) {
  const float x = hit.position.x();
  const float y = hit.position.y();
  const float w = SurfaceFootprint(hit);
  Surface surface;
  const float above = hit.position.z() - water_z_m;
  const float damp = FractalNoise(x, y, {24.0F, 4, 0.5F}, seed + 500U, w);
  const float wet = std::clamp(1.0F - Smoothstep(0.05F, 0.55F, above + 0.22F * damp), 0.0F, 1.0F);
  // Standing films of water in the hollows between the banks.
  const float film_noise = FractalNoise(x, y, {17.0F, 4, 0.5F}, seed + 600U, w) - 0.9F * (above - 0.45F);
  const float film = std::max(Smoothstep(0.34F, 0.46F, film_noise), Smoothstep(0.75F, 0.95F, wet) * 0.8F);
  surface.albedo = DrySand(x, y, w, seed) * (1.0F - 0.5F * std::max(wet, 0.85F * film));
  // Ripples: bent rows 0.9 m apart, gone under water films and where a pixel swallows them.
  constexpr float kRipple = 0.9F;
  const float visible = std::clamp(kRipple / (3.0F * w) - 0.6F, 0.0F, 1.0F);
  const float field = Smoothstep(-0.4F, 0.4F, FractalNoise(x, y, {30.0F, 3, 0.5F}, seed + 700U, w));
  const float bend = 1.9F * FractalNoise(x, y, {16.0F, 3, 0.45F}, seed + 800U, 0.0F);
  const float phase = 6.2831853F / kRipple * (0.86F * x + 0.5F * y + bend);
  const float strength = visible * field * (1.0F - film);
  const float slope = 0.13F * strength * std::cos(phase);
  surface.normal = (hit.normal + Vector3f(-0.86F * slope, -0.5F * slope, 0.0F)).normalized();
  surface.albedo *= 1.0F - 0.07F * strength * std::sin(phase);
  surface.mirror = 0.045F;
  surface.mirror_share = film;
  surface.mirror_normal = WaveNormal(x, y, 5.0F, 0.004F, w, seed + 850U);
  return surface;
}

Surface TidalWater(const Terrain& bed, const Hit& hit, uint32_t seed) {
  const float x = hit.position.x();
  const float y = hit.position.y();
  const float w = SurfaceFootprint(hit);
  const float depth = std::max(hit.position.z() - bed.Height(x, y), 0.0F);
  const Vector3f sand = 0.5F * DrySand(x, y, w, seed);
  const Vector3f through = Vector3f(-2.6F * depth, -1.6F * depth, -1.9F * depth).array().exp();
  Surface surface;
  surface.albedo = sand.cwiseProduct(through) + Vector3f(0.055F, 0.085F, 0.078F).cwiseProduct(Vector3f::Ones() - through);
  surface.mirror = 0.03F;
  surface.mirror_normal = WaveNormal(x, y, 1.8F, 0.022F, w, seed + 870U);
  return surface;
}

}  // namespace skyquilt::simulate
