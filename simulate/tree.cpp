#include "simulate/tree.h"

#include <array>
#include <cmath>
#include <numbers>

#include "simulate/noise.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3f;

void AddTrunk(const Vector3f& foot, float height, float radius, uint32_t index, Mesh& mesh) {
  constexpr int kSides = 5;
  const auto Corner = [&](int i, float z) {
    const float angle = 2.0F * std::numbers::pi_v<float> * static_cast<float>(i) / kSides;
    return Vector3f(foot + Vector3f(radius * std::cos(angle), radius * std::sin(angle), z));
  };
  for (int i = 0; i < kSides; ++i)
    mesh.AddQuad(Corner(i, -0.5F), Corner(i + 1, -0.5F), Corner(i + 1, height), Corner(i, height), {Part::kTrunk, index});
}

// A sphere whose radius varies with the direction by value noise.
void AddCrown(const Vector3f& centre, const Vector3f& radii, uint32_t seed, int detail, uint32_t index, Mesh& mesh) {
  mesh.AddSphere(detail,
                 [&](const Vector3f& unit) {
                   const float lumps = ValueNoise(2.1F * unit.x() + 0.9F * unit.z() + 7.0F, 2.1F * unit.y() - 0.8F * unit.z(), seed) +
                                       0.6F * ValueNoise(4.5F * unit.x() - 1.7F * unit.z(), 4.5F * unit.y() + 2.1F * unit.z(), seed + 1);
                   return Vector3f(centre + unit.cwiseProduct(radii) * (1.0F + 0.17F * lumps));
                 },
                 {Part::kLeaves, index});
}

}  // namespace

void AddTree(const Tree& tree, uint32_t index, int detail, Mesh& mesh) {
  const Vector3f foot(static_cast<float>(tree.position.x()), static_cast<float>(tree.position.y()), static_cast<float>(tree.ground_z_m));
  const auto height = static_cast<float>(tree.height_m);
  const auto radius = static_cast<float>(tree.crown_radius_m);
  AddTrunk(foot, 0.6F * height, 0.025F * height, index, mesh);
  if (tree.conifer) {
    for (int tier = 0; tier < 3; ++tier) {
      const auto k = static_cast<float>(tier);
      AddCrown(foot + Vector3f(0, 0, height * (0.32F + 0.24F * k)), {radius * (0.85F - 0.25F * k), radius * (0.85F - 0.25F * k), 0.19F * height},
               tree.seed + 10U * static_cast<uint32_t>(tier), detail, index, mesh);
    }
    return;
  }
  const float crown_height = 0.62F * height;
  AddCrown(foot + Vector3f(0, 0, height - 0.5F * crown_height), {0.8F * radius, 0.8F * radius, 0.5F * crown_height}, tree.seed, detail, index, mesh);
  for (int lobe = 0; lobe < 3; ++lobe) {
    const float angle = 2.0F * std::numbers::pi_v<float> * (static_cast<float>(lobe) + HashUnit(lobe, 1, tree.seed)) / 3.0F;
    const float out = radius * (0.42F + 0.12F * HashUnit(lobe, 2, tree.seed));
    const float size = radius * (0.45F + 0.15F * HashUnit(lobe, 3, tree.seed));
    AddCrown(foot + Vector3f(out * std::cos(angle), out * std::sin(angle), height * (0.50F + 0.18F * HashUnit(lobe, 4, tree.seed))),
             {size, size, 0.8F * size}, tree.seed + 20U + static_cast<uint32_t>(lobe), detail, index, mesh);
  }
}

}  // namespace skyquilt::simulate
