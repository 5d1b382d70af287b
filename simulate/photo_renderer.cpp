#include "simulate/photo_renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include "core/base/errors.h"
#include "core/survey/surface_class.h"
#include "simulate/classify.h"

namespace skyquilt::simulate {

using Eigen::Vector3f;

struct PhotoRenderer::Frame {
  Vector3f origin;
  Eigen::Matrix3f enu_from_cam;
};

PhotoRenderer::PhotoRenderer(const World& world, int width, int height, double pixel_angle, RayFromImg ray_from_img, int samples_per_pixel,
                             bool soft_shadows)
    : world_(world),
      width_(width),
      height_(height),
      pixel_angle_(pixel_angle),
      ray_from_img_(std::move(ray_from_img)),
      shader_(world, soft_shadows),
      grid_(SamplesPerSide(samples_per_pixel)) {
  sample_direction_.reserve(static_cast<size_t>(width * grid_) * static_cast<size_t>(height * grid_));
  for (int y = 0; y < height * grid_; ++y) {
    for (int x = 0; x < width * grid_; ++x) sample_direction_.push_back(ray_from_img_({(x + 0.5) / grid_, (y + 0.5) / grid_}).cast<float>());
  }
}

PhotoRenderer::PhotoRenderer(const World& world, const camera::Camera& camera, int samples_per_pixel, bool soft_shadows)
    : PhotoRenderer(
          world, camera.width, camera.height, 1.0 / camera.FocalX(), [camera](const Eigen::Vector2d& pixel) { return camera.RayFromImg(pixel); },
          samples_per_pixel, soft_shadows) {}

PhotoRenderer::PhotoRenderer(const World& world, const camera::Equirectangular& panorama, int samples_per_pixel, bool soft_shadows)
    : PhotoRenderer(
          world, panorama.width, panorama.height, 2.0 * std::numbers::pi / panorama.width,
          [panorama](const Eigen::Vector2d& pixel) { return panorama.RayFromImg(pixel); }, samples_per_pixel, soft_shadows) {}

void PhotoRenderer::SetRays(const Frame& frame, int tile_x, int tile_y, raytrace::RayPacket& rays) const {
  const int width = width_ * grid_;
  const int height = height_ * grid_;
  for (int lane = 0; lane < static_cast<int>(raytrace::kPacket); ++lane) {
    const int x = tile_x * kPacketSide + lane % kPacketSide;
    const int y = tile_y * kPacketSide + lane / kPacketSide;
    const bool inside = x < width && y < height;
    const size_t index = static_cast<size_t>(std::min(y, height - 1)) * static_cast<size_t>(width) + static_cast<size_t>(std::min(x, width - 1));
    rays.Set(static_cast<size_t>(lane), frame.origin, frame.enu_from_cam * sample_direction_[index], 0.1F, kFarthestHit_m);
    if (!inside) rays.valid[static_cast<size_t>(lane)] = 0;
  }
}

void PhotoRenderer::ShadeTile(const Frame& frame, const MovingScene& moving, int tile_x, int tile_y, Rendering& out,
                              std::vector<char>& row_masked) const {
  raytrace::RayPacket rays;
  SetRays(frame, tile_x, tile_y, rays);
  const RayLight light = shader_.Trace(moving, {0.0F, static_cast<float>(pixel_angle_)}, rays);
  const float weight = 1.0F / static_cast<float>(grid_ * grid_);
  for (size_t lane = 0; lane < raytrace::kPacket; ++lane) {
    if (rays.valid[lane] == 0) continue;
    const int x = (tile_x * kPacketSide + static_cast<int>(lane) % kPacketSide) / grid_;
    const int y = (tile_y * kPacketSide + static_cast<int>(lane) / kPacketSide) / grid_;
    float* pixel = out.rgb_linear.At(x, y);
    for (Eigen::Index c = 0; c < 3; ++c) pixel[c] += weight * light.radiance[lane][c];
    if (((light.moved >> lane) & 1U) != 0) {
      *out.usable.At(x, y) = 0;
      row_masked[static_cast<size_t>(tile_y)] = 1;
    }
  }
}

Rendering PhotoRenderer::Render(const geo::Rigid3d& cam_from_enu, const MovingScene& moving, base::ThreadPool& threads,
                                const std::function<void(double share)>& advance) const {
  Rendering out;
  out.rgb_linear = image::ImageF(width_, height_, 3);
  out.usable = image::Image8(width_, height_, 1, 255);
  const Frame frame{cam_from_enu.OriginInSource().cast<float>(), cam_from_enu.rotation.conjugate().toRotationMatrix().cast<float>()};
  const int tiles_x = (width_ * grid_ + kPacketSide - 1) / kPacketSide;
  const int tiles_y = (height_ * grid_ + kPacketSide - 1) / kPacketSide;
  std::vector<char> row_masked(static_cast<size_t>(tiles_y), 0);
  threads.ParallelFor(tiles_y, [&](int64_t tile_y, int /*thread*/) {
    for (int tile_x = 0; tile_x < tiles_x; ++tile_x) ShadeTile(frame, moving, tile_x, static_cast<int>(tile_y), out, row_masked);
    if (advance) advance(1.0 / tiles_y);
  });
  if (std::all_of(row_masked.begin(), row_masked.end(), [](char masked) { return masked == 0; })) out.usable = image::Image8();
  return out;
}

SurfaceImages PhotoRenderer::Surfaces(const geo::Rigid3d& cam_from_enu, const MovingScene& moving, base::ThreadPool& threads) const {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  SurfaceImages out{image::ImageF(width_, height_, 1, kNan), image::ImageF(width_, height_, 3, kNan),
                    image::Image8(width_, height_, 1, static_cast<uint8_t>(survey::SurfaceClass::kNone))};
  const Vector3f origin = cam_from_enu.OriginInSource().cast<float>();
  const Eigen::Matrix3d enu_from_cam = cam_from_enu.rotation.conjugate().toRotationMatrix();
  const int packet = static_cast<int>(raytrace::kPacket);
  threads.ParallelFor(height_, [&](int64_t row, int /*thread*/) {
    const int y = static_cast<int>(row);
    raytrace::RayPacket rays;
    std::array<double, raytrace::kPacket> z_per_metre{};
    for (int begin = 0; begin < width_; begin += packet) {
      const int n = std::min(packet, width_ - begin);
      for (int lane = 0; lane < packet; ++lane) {
        const auto slot = static_cast<size_t>(lane);
        const Eigen::Vector3d in_cam = ray_from_img_({std::min(begin + lane, width_ - 1) + 0.5, y + 0.5});
        z_per_metre[slot] = in_cam.z();
        rays.Set(slot, origin, (enu_from_cam * in_cam).cast<float>(), 0.1F, kFarthestHit_m);
        if (lane >= n) rays.valid[slot] = 0;
      }
      world_.scene().Intersect(rays);
      const uint32_t on_moving = moving.scene.Intersect(rays);
      for (int lane = 0; lane < n; ++lane) {
        const auto slot = static_cast<size_t>(lane);
        const uint32_t triangle = rays.triangle[slot];
        if (triangle == raytrace::kNoTriangle) continue;
        const int x = begin + lane;
        const bool moves = ((on_moving >> slot) & 1U) != 0;
        const Mesh& mesh = moves ? moving.mesh : world_.mesh();
        const Vector3f direction(rays.dx[slot], rays.dy[slot], rays.dz[slot]);
        const Vector3f face = mesh.FaceNormal(triangle);
        const Vector3f normal = face.dot(direction) > 0.0F ? Vector3f(-face) : face;
        const survey::SurfaceClass seen = moves ? ClassOfMoving(mesh.tag[triangle])
                                                : ClassOf(mesh.tag[triangle], origin + rays.t_far[slot] * direction, world_.city(), world_.marsh());
        *out.z_depth.At(x, y) = static_cast<float>(z_per_metre[slot] * static_cast<double>(rays.t_far[slot]));
        std::copy_n(normal.data(), 3, out.normals.At(x, y));
        *out.classes.At(x, y) = static_cast<uint8_t>(seen);
      }
    }
  });
  return out;
}

}  // namespace skyquilt::simulate
