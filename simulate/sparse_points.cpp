#include "simulate/sparse_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/base/random.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr size_t kMinTrack = 3;
constexpr double kBorder_px = 2.0;

struct View {
  geo::Rigid3d cam_from_enu;
  Vector3d centre;
  Vector3d axis;  // optical axis in ENU
};

struct Found {
  Vector3f position;
  Vector3f normal;
};

bool HitByMovingCar(const MovingScene& moving, const Vector3f& origin, const Vector3f& direction, float far_m) {
  raytrace::RayPacket ray;
  ray.valid.fill(0);
  ray.Set(0, origin, direction, 0.1F, far_m);
  return moving.scene.Occluded(ray) != 0;
}

// The static surface at a pixel, if a feature could be found there.
std::optional<Found> TraceSeed(const World& world, const MovingScene& moving, const camera::Camera& camera, const View& view,
                               const SurfaceSeed& seed) {
  const Vector3d direction = view.cam_from_enu.rotation.conjugate() * camera.RayFromImg({seed.x + 0.5, seed.y + 0.5});
  raytrace::RayPacket ray;
  ray.valid.fill(0);
  ray.Set(0, view.centre.cast<float>(), direction.cast<float>(), 0.1F, 1e6F);
  world.scene().Intersect(ray);
  if (ray.triangle[0] == raytrace::kNoTriangle) return std::nullopt;
  const Mesh& mesh = world.mesh();
  const Part part = mesh.tag[ray.triangle[0]].part;
  if (part == Part::kWater) return std::nullopt;
  Vector3f normal = mesh.FaceNormal(ray.triangle[0]);
  const Vector3f d = direction.cast<float>();
  if (normal.dot(d) > 0.0F) normal = -normal;
  if (-normal.dot(d) < 0.2F) return std::nullopt;
  if (HitByMovingCar(moving, view.centre.cast<float>(), d, ray.t_far[0])) return std::nullopt;
  return Found{view.centre.cast<float>() + ray.t_far[0] * d, normal};
}

// Indices of the photos that see the point.
std::vector<uint32_t> Track(const World& world, const std::vector<MovingScene>& moving, const camera::Camera& camera, const std::vector<View>& views,
                            double cos_half_view, const Found& found) {
  std::vector<uint32_t> track;
  const Vector3d point = found.position.cast<double>();
  raytrace::RayPacket rays;
  std::array<uint32_t, raytrace::kPacket> photo{};
  size_t n = 0;
  rays.valid.fill(0);
  const auto Flush = [&] {
    const uint32_t occluded = world.scene().Occluded(rays);
    for (size_t lane = 0; lane < n; ++lane) {
      if (((occluded >> lane) & 1U) != 0) continue;
      const Vector3f direction(-rays.dx[lane], -rays.dy[lane], -rays.dz[lane]);
      if (!HitByMovingCar(moving[photo[lane]], views[photo[lane]].centre.cast<float>(), direction, rays.t_far[lane])) track.push_back(photo[lane]);
    }
    n = 0;
    rays.valid.fill(0);
  };
  for (size_t i = 0; i < views.size(); ++i) {
    const Vector3d to_camera = views[i].centre - point;
    const double distance = to_camera.norm();
    if (-to_camera.dot(views[i].axis) < cos_half_view * distance) continue;
    const Vector3f direction = (to_camera / distance).cast<float>();
    if (found.normal.dot(direction) < 0.2F) continue;
    const std::optional<Eigen::Vector2d> pixel = camera.ImgFromCam(views[i].cam_from_enu * point);
    if (!pixel || pixel->minCoeff() < kBorder_px || pixel->x() > camera.width - kBorder_px || pixel->y() > camera.height - kBorder_px) continue;
    photo[n] = static_cast<uint32_t>(i);
    rays.Set(n++, found.position + 0.01F * found.normal, direction, 0.01F, static_cast<float>(distance));
    if (n == raytrace::kPacket) Flush();
  }
  if (n > 0) Flush();
  return track;
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

std::vector<survey::ColmapPoint> MakeSparsePoints(const World& world, const camera::Camera& camera, const std::vector<PhotoPlan>& photos,
                                                  const std::vector<SurfaceSeed>& seeds, uint32_t seed, base::ThreadPool& threads) {
  std::vector<View> views;
  std::vector<MovingScene> moving;
  for (const PhotoPlan& photo : photos) {
    views.push_back({photo.cam_from_enu, photo.cam_from_enu.OriginInSource(), photo.cam_from_enu.rotation.conjugate() * Vector3d::UnitZ()});
    moving.push_back(world.MovingAt(photo.time_s));
  }
  // A point farther from the optical axis than the image corners is not in the photo.
  double cos_half_view = 1.0;
  for (const double x : {0.0, static_cast<double>(camera.width)}) {
    for (const double y : {0.0, static_cast<double>(camera.height)}) cos_half_view = std::min(cos_half_view, camera.RayFromImg({x, y}).z());
  }
  std::vector<std::optional<survey::ColmapPoint>> made(seeds.size());
  threads.ParallelFor(static_cast<int64_t>(seeds.size()), [&](int64_t task, int /*thread*/) {
    const SurfaceSeed& chosen = seeds[static_cast<size_t>(task)];
    const auto photo = static_cast<size_t>(chosen.photo);
    const std::optional<Found> found = TraceSeed(world, moving[photo], camera, views[photo], chosen);
    if (!found) return;
    survey::ColmapPoint point;
    for (const uint32_t index : Track(world, moving, camera, views, cos_half_view - 1e-3, *found)) point.image_ids.push_back(index + 1);
    if (point.image_ids.size() < kMinTrack) return;
    base::Random random(seed, 900000U + static_cast<uint64_t>(task));
    point.error_px = std::clamp(0.4 + 0.08 * random.Normal(), 0.15, 0.9);
    // More views give smaller errors; along the viewing direction they are larger.
    const double gsd = (views[photo].centre - found->position.cast<double>()).norm() / camera.FocalX();
    const double sigma = 0.5 * point.error_px * gsd / std::sqrt(static_cast<double>(point.image_ids.size()));
    const Vector3d error(sigma * random.Normal(), sigma * random.Normal(), 2.0 * sigma * random.Normal());
    point.x_in_world = found->position.cast<double>() + error;
    point.rgb = chosen.rgb;
    made[static_cast<size_t>(task)] = std::move(point);
  });
  std::vector<survey::ColmapPoint> points;
  for (std::optional<survey::ColmapPoint>& point : made) {
    if (!point) continue;
    point->id = points.size() + 1;
    points.push_back(std::move(*point));
  }
  return points;
}

}  // namespace skyquilt::simulate
