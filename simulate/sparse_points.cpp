#include "simulate/sparse_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/progress.h"
#include "core/base/random.h"
#include "simulate/point_views.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr size_t kMinTrack = 3;
constexpr double kBorder_px = 2.0;

struct Found {
  Vector3f position;
  Vector3f normal;
};

// The static surface at a pixel, if a feature could be found there.
std::optional<Found> TraceSeed(const World& world, const PointViews& views, const camera::Camera& camera, const PhotoPlan& photo,
                               const SurfaceSeed& seed) {
  const Vector3d direction = photo.cam_from_enu.rotation.conjugate() * camera.RayFromImg({seed.x + 0.5, seed.y + 0.5});
  const Vector3f centre = views.Centre(static_cast<size_t>(seed.photo)).cast<float>();
  raytrace::RayPacket ray;
  ray.valid.fill(0);
  ray.Set(0, centre, direction.cast<float>(), 0.1F, 1e6F);
  world.scene().Intersect(ray);
  if (ray.triangle[0] == raytrace::kNoTriangle) return std::nullopt;
  const Mesh& mesh = world.mesh();
  const Part part = mesh.tag[ray.triangle[0]].part;
  if (part == Part::kWater) return std::nullopt;
  Vector3f normal = mesh.FaceNormal(ray.triangle[0]);
  const Vector3f d = direction.cast<float>();
  if (normal.dot(d) > 0.0F) normal = -normal;
  if (-normal.dot(d) < 0.2F) return std::nullopt;
  if (views.HiddenByCar(static_cast<size_t>(seed.photo), d, ray.t_far[0])) return std::nullopt;
  return Found{centre + ray.t_far[0] * d, normal};
}

}  // namespace

std::vector<SurfaceSeed> ChooseSeeds(const camera::Camera& camera, int photo, int count, uint32_t seed) {
  base::Random random(seed, 500000U + static_cast<uint64_t>(photo));
  std::vector<SurfaceSeed> seeds;
  // One random pixel per cell of a grid: evenly spread, as features of a detector are.
  const int columns = std::max(1, static_cast<int>(std::lround(std::sqrt(static_cast<double>(count) * camera.width / camera.height))));
  const int rows = std::max(1, (count + columns - 1) / columns);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      SurfaceSeed chosen;
      chosen.photo = photo;
      chosen.x = std::min(static_cast<int>((i + random.UniformDouble()) * camera.width / columns), camera.width - 1);
      chosen.y = std::min(static_cast<int>((j + random.UniformDouble()) * camera.height / rows), camera.height - 1);
      seeds.push_back(chosen);
    }
  }
  return seeds;
}

bool HasTexture(const image::Image8& rgb, int x, int y) {
  constexpr int kReach_px = 2;
  constexpr int kContrast = 12;  // grey levels
  int low = 255, high = 0;
  for (int j = std::max(y - kReach_px, 0); j <= std::min(y + kReach_px, rgb.height - 1); ++j) {
    for (int i = std::max(x - kReach_px, 0); i <= std::min(x + kReach_px, rgb.width - 1); ++i) {
      const int green = rgb.At(i, j)[1];
      low = std::min(low, green);
      high = std::max(high, green);
    }
  }
  return high - low >= kContrast;
}

std::vector<survey::ColmapPoint> MakeSparsePoints(const World& world, const camera::Camera& camera, const std::vector<PhotoPlan>& photos,
                                                  const std::vector<SurfaceSeed>& seeds, uint32_t seed, base::ThreadPool& threads) {
  const PointViews views(world, camera, photos);
  std::vector<std::optional<survey::ColmapPoint>> of_seed(seeds.size());
  base::Progress progress("sparse points", static_cast<double>(seeds.size()), "points");
  threads.ParallelFor(static_cast<int64_t>(seeds.size()), [&](int64_t task, int /*thread*/) {
    base::ThrowIfCancelled();
    progress.Advance();
    const SurfaceSeed& chosen = seeds[static_cast<size_t>(task)];
    const auto photo = static_cast<size_t>(chosen.photo);
    const std::optional<Found> found = TraceSeed(world, views, camera, photos[photo], chosen);
    if (!found) return;
    survey::ColmapPoint point;
    for (const uint32_t index : views.Seeing(found->position, found->normal, kBorder_px)) point.image_ids.push_back(index + 1);
    if (point.image_ids.size() < kMinTrack) return;
    base::Random random(seed, 900000U + static_cast<uint64_t>(task));
    point.error_px = std::clamp(0.4 + 0.08 * random.Normal(), 0.15, 0.9);
    // More views give smaller errors; along the viewing direction they are larger.
    const double gsd = (views.Centre(photo) - found->position.cast<double>()).norm() / camera.FocalX();
    const double sigma = 0.5 * point.error_px * gsd / std::sqrt(static_cast<double>(point.image_ids.size()));
    const double error_z = 2.0 * sigma * random.Normal(), error_y = sigma * random.Normal(), error_x = sigma * random.Normal();
    const Vector3d error(error_x, error_y, error_z);
    point.x_in_world = found->position.cast<double>() + error;
    point.rgb = chosen.rgb;
    of_seed[static_cast<size_t>(task)] = std::move(point);
  });
  progress.Finish();
  std::vector<survey::ColmapPoint> points;
  for (std::optional<survey::ColmapPoint>& point : of_seed) {
    if (!point) continue;
    point->id = points.size() + 1;
    points.push_back(std::move(*point));
  }
  return points;
}

}  // namespace skyquilt::simulate
