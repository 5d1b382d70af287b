#include "simulate/ambient_volume.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/cancel.h"
#include "core/base/progress.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3f;

constexpr size_t kDirections = 32;  // over the upper half of the sphere; from below comes the ground's mean light
static_assert(kDirections % raytrace::kPacket == 0);

constexpr float kShare = 0.5F / static_cast<float>(kDirections);  // of the whole sphere

std::array<Vector3f, kDirections> SkyDirections() {
  std::array<Vector3f, kDirections> directions;
  for (size_t i = 0; i < kDirections; ++i) {
    const double z = 1.0 - (static_cast<double>(i) + 0.5) / kDirections;
    const double angle = static_cast<double>(i) * std::numbers::pi * (3.0 - std::sqrt(5.0));
    const double r = std::sqrt(1.0 - z * z);
    directions[i] = Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z).cast<float>();
  }
  return directions;
}

}  // namespace

AmbientVolume::AmbientVolume(const Mesh& mesh, const raytrace::TracedScene& scene, const Sky& sky, float voxel_m, base::ThreadPool& threads)
    : voxel_m_(voxel_m) {
  Vector3f low = Vector3f::Constant(std::numeric_limits<float>::max());
  Vector3f high = -low;
  for (const Vector3f& p : mesh.position) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  min_ = low;
  const Vector3f extent = high - low;
  for (int axis = 0; axis < 3; ++axis) size_[static_cast<size_t>(axis)] = static_cast<int>(extent[axis] / voxel_m) + 2;
  const std::array<Vector3f, kDirections> directions = SkyDirections();
  const auto nx = static_cast<size_t>(size_[0]);
  const auto ny = static_cast<size_t>(size_[1]);
  const auto nz = static_cast<size_t>(size_[2]);
  node_.resize(nx * ny * nz);
  std::array<Vector3f, kDirections> open_sky;
  for (size_t k = 0; k < kDirections; ++k) open_sky[k] = sky.Radiance(directions[k]);
  base::Progress progress("light of the sky", static_cast<double>(ny * nz), "rows");
  threads.ParallelFor(static_cast<int64_t>(ny * nz), [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    progress.Advance();
    const auto row = static_cast<size_t>(task);
    raytrace::RayPacket rays;
    for (size_t i = 0; i < nx; ++i) {
      // Slightly off the grid nodes, because walls may coincide with grid planes.
      const Vector3f place =
          min_ + voxel_m_ * Vector3f(static_cast<float>(i) + 0.013F, static_cast<float>(row % ny) + 0.017F, static_cast<float>(row / ny) + 0.11F);
      Node& node = node_[row * nx + i];
      int n_inside = 0;
      // The lower half of the sphere at once: the mean of its directions is (0, 0, -0.5).
      node.harmonics.col(0) = 0.5F * 0.85F * sky.ground_radiance();
      node.harmonics.col(3) = -0.25F * 3.0F * 0.85F * sky.ground_radiance();
      for (size_t begin = 0; begin < kDirections; begin += raytrace::kPacket) {
        for (size_t lane = 0; lane < raytrace::kPacket; ++lane) rays.Set(lane, place, directions[begin + lane], 0.0F, 1e6F);
        scene.Intersect(rays);
        for (size_t lane = 0; lane < raytrace::kPacket; ++lane) {
          const Vector3f& d = directions[begin + lane];
          const uint32_t hit = rays.triangle[lane];
          // A node that sees the back of a closed surface is inside it.
          if (hit != raytrace::kNoTriangle && mesh.FaceNormal(hit).dot(d) > 0.0F && mesh.tag[hit].part != Part::kLeaves) ++n_inside;
          const Vector3f light = hit == raytrace::kNoTriangle ? open_sky[begin + lane] : Vector3f(0.85F * sky.ground_radiance());
          node.harmonics.col(0) += light * kShare;
          node.harmonics.rightCols<3>() += light * d.transpose() * (3.0F * kShare);
        }
      }
      // Nodes inside solids count only where all eight neighbours are inside.
      node.weight = n_inside > static_cast<int>(kDirections) / 4 ? 1e-4F : 1.0F;
    }
  });
  progress.Finish();
}

Vector3f AmbientVolume::Irradiance(const Vector3f& position, const Vector3f& normal) const {
  const Vector3f at = (position + 0.6F * voxel_m_ * normal - min_) / voxel_m_;
  std::array<size_t, 3> cell{};
  Vector3f fraction;
  for (size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const float x = std::clamp(at[i], 0.0F, static_cast<float>(size_[axis] - 1) - 1e-3F);
    cell[axis] = static_cast<size_t>(x);
    fraction[i] = x - static_cast<float>(cell[axis]);
  }
  const auto nx = static_cast<size_t>(size_[0]);
  const auto ny = static_cast<size_t>(size_[1]);
  Eigen::Matrix<float, 3, 4> sum = Eigen::Matrix<float, 3, 4>::Zero();
  float total = 0.0F;
  for (size_t corner = 0; corner < 8; ++corner) {
    const size_t dx = corner & 1U;
    const size_t dy = (corner >> 1U) & 1U;
    const size_t dz = corner >> 2U;
    const Node& node = node_[((cell[2] + dz) * ny + cell[1] + dy) * nx + cell[0] + dx];
    const float weight = node.weight * (dx != 0 ? fraction.x() : 1.0F - fraction.x()) * (dy != 0 ? fraction.y() : 1.0F - fraction.y()) *
                         (dz != 0 ? fraction.z() : 1.0F - fraction.z());
    sum += weight * node.harmonics;
    total += weight;
  }
  if (total <= 0.0F) return Vector3f::Zero();
  const Vector3f mean = sum.col(0) / total;
  const Vector3f slope = sum.rightCols<3>() * normal / total;
  return (mean + (2.0F / 3.0F) * slope).cwiseMax(0.1F * mean);
}

}  // namespace skyquilt::simulate
