#include "simulate/salt_marsh.h"

#include <algorithm>

#include "core/base/random.h"
#include "simulate/ground_material.h"
#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

constexpr float kLowestPlants_m = 0.45F;  // above the water
constexpr double kLowestTree_m = 0.6;
constexpr int kTrees = 60;
constexpr int kTriesPerTree = 40;

}  // namespace

SaltMarsh::SaltMarsh(const Eigen::Vector2d& min, const Eigen::Vector2d& max, const std::function<double(const Eigen::Vector2d&)>& ground_z,
                     double water_z_m, uint32_t seed)
    : water_z_m_(static_cast<float>(water_z_m)), seed_(seed) {
  base::Random random(seed, 11);
  for (int tries = 0; tries < kTrees * kTriesPerTree && trees_.size() < kTrees; ++tries) {
    Tree tree;
    tree.position = {random.Uniform(min.x(), max.x()), random.Uniform(min.y(), max.y())};
    tree.ground_z_m = ground_z(tree.position);
    tree.height_m = random.Uniform(3.5, 8.0);
    tree.crown_radius_m = random.Uniform(1.4, 2.8);
    tree.seed = random.NextU32();
    const Eigen::Vector3f foot(static_cast<float>(tree.position.x()), static_cast<float>(tree.position.y()), static_cast<float>(tree.ground_z_m));
    if (tree.ground_z_m - water_z_m > kLowestTree_m && Covers(foot)) trees_.push_back(tree);
  }
}

bool SaltMarsh::Covers(const Eigen::Vector3f& position) const {
  const float above = position.z() - water_z_m_;
  const float patch = FractalNoise(position.x(), position.y(), {45.0F, 4, 0.5F}, seed_ + 1200U, 0.0F);
  return above > kLowestPlants_m && patch + 0.5F * (above - kLowestPlants_m) > 0.15F;
}

Surface SaltMarsh::Over(const Surface& sand, const Hit& hit) const {
  if (!Covers(hit.position)) return sand;
  const float x = hit.position.x(), y = hit.position.y();
  const float w = SurfaceFootprint(hit);
  // Green glasswort with browner patches, in tufts.
  const float kind = Smoothstep(-0.3F, 0.5F, FractalNoise(x, y, {12.0F, 3, 0.5F}, seed_ + 1300U, w));
  const float tuft = 1.0F + 0.35F * FractalNoise(x, y, {1.4F, 3, 0.6F}, seed_ + 1400U, w);
  Surface plants;
  plants.normal = hit.normal;
  plants.albedo = (Eigen::Vector3f(0.055F, 0.095F, 0.028F) + kind * Eigen::Vector3f(0.060F, 0.020F, 0.012F)) * tuft;
  return plants;
}

}  // namespace skyquilt::simulate
