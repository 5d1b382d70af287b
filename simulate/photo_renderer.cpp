#include "simulate/photo_renderer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "core/base/errors.h"
#include "core/survey/surface_class.h"
#include "simulate/classify.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3f;

constexpr int kTile = 4;  // samples per side of a packet
static_assert(kTile * kTile == static_cast<int>(raytrace::kPacket));
constexpr float kFar = 1e6F;
constexpr float kSunRadius_rad = 0.00465F;

}  // namespace

struct PhotoRenderer::Frame {
  Vector3f origin;
  Eigen::Matrix3f enu_from_cam;
};

PhotoRenderer::PhotoRenderer(const World& world, const camera::Camera& camera, int samples_per_pixel, bool soft_shadows)
    : world_(world), camera_(camera), grid_(samples_per_pixel == 16 ? 4 : (samples_per_pixel == 4 ? 2 : 1)), soft_shadows_(soft_shadows) {
  SKYQUILT_CHECK(samples_per_pixel == grid_ * grid_, "samples_per_pixel is " + std::to_string(samples_per_pixel));
  const int width = camera.width * grid_;
  const int height = camera.height * grid_;
  sample_direction_.reserve(static_cast<size_t>(width) * static_cast<size_t>(height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) sample_direction_.push_back(camera.RayFromImg({(x + 0.5) / grid_, (y + 0.5) / grid_}).cast<float>());
  }
}

void PhotoRenderer::Trace(const Frame& frame, const MovingScene& moving, int tile_x, int tile_y, raytrace::RayPacket& rays,
                          uint32_t* on_moving) const {
  const int width = camera_.width * grid_;
  const int height = camera_.height * grid_;
  for (int lane = 0; lane < static_cast<int>(raytrace::kPacket); ++lane) {
    const int x = tile_x * kTile + lane % kTile;
    const int y = tile_y * kTile + lane / kTile;
    const bool inside = x < width && y < height;
    const size_t index = static_cast<size_t>(std::min(y, height - 1)) * static_cast<size_t>(width) + static_cast<size_t>(std::min(x, width - 1));
    rays.Set(static_cast<size_t>(lane), frame.origin, frame.enu_from_cam * sample_direction_[index], 0.1F, kFar);
    if (!inside) rays.valid[static_cast<size_t>(lane)] = 0;
  }
  world_.scene().Intersect(rays);
  *on_moving = moving.scene.Intersect(rays);
}

Vector3f PhotoRenderer::Shade(const Hit& hit, const Surface& surface, float sun_share) const {
  const Sky& sky = world_.sky();
  float cosine = surface.normal.dot(sky.sun_direction());
  // Leaves let light through, so their shading is softer.
  if (hit.tag.part == Part::kLeaves) cosine = (cosine + 0.3F) / 1.3F;
  const Vector3f light = sky.sun_over_pi() * (sun_share * std::max(cosine, 0.0F)) + world_.ambient().Irradiance(hit.position, surface.normal);
  Vector3f radiance = surface.albedo.cwiseProduct(light);
  if (surface.mirror > 0.0F && surface.mirror_share > 0.0F) {
    const float facing = std::clamp(-hit.direction.dot(surface.mirror_normal), 0.0F, 1.0F);
    const float grazing = 1.0F - facing;
    const float grazing2 = grazing * grazing;
    const float fresnel = surface.mirror + (1.0F - surface.mirror) * grazing2 * grazing2 * grazing;
    const Vector3f mirrored = hit.direction - 2.0F * hit.direction.dot(surface.mirror_normal) * surface.mirror_normal;
    const float share = surface.mirror_share * fresnel;
    radiance = (1.0F - share) * radiance + share * (sky.Radiance(mirrored) + sun_share * sky.SunGlow(mirrored));
  }
  return radiance;
}

void PhotoRenderer::ShadeTile(const Frame& frame, const MovingScene& moving, int tile_x, int tile_y, Rendering& out,
                              std::vector<char>& row_masked) const {
  raytrace::RayPacket rays;
  uint32_t on_moving = 0;
  Trace(frame, moving, tile_x, tile_y, rays, &on_moving);
  std::array<Hit, raytrace::kPacket> hits;
  raytrace::RayPacket shadow;
  shadow.valid.fill(0);
  const Vector3f& sun = world_.sky().sun_direction();
  const Vector3f sun_right = sun.unitOrthogonal();
  const Vector3f sun_up = sun.cross(sun_right);
  const auto pixel_angle = static_cast<float>(1.0 / camera_.FocalX());
  for (size_t lane = 0; lane < raytrace::kPacket; ++lane) {
    if (rays.valid[lane] == 0 || rays.triangle[lane] == raytrace::kNoTriangle) continue;
    const Mesh& mesh = ((on_moving >> lane) & 1U) != 0 ? moving.mesh : world_.mesh();
    Hit& hit = hits[lane];
    hit.direction = {rays.dx[lane], rays.dy[lane], rays.dz[lane]};
    hit.position = frame.origin + rays.t_far[lane] * hit.direction;
    hit.tag = mesh.tag[rays.triangle[lane]];
    hit.footprint_m = rays.t_far[lane] * pixel_angle;
    Vector3f face = mesh.FaceNormal(rays.triangle[lane]);
    hit.normal = mesh.ShadingNormal(rays.triangle[lane], rays.u[lane], rays.v[lane]);
    if (face.dot(hit.direction) > 0.0F) {
      face = -face;
      hit.normal = -hit.normal;
    }
    Vector3f towards = sun;
    if (soft_shadows_) {
      // Each sample of a 2 x 2 square uses another point of the sun's disc.
      const float a = (lane % 2 == 0 ? 0.35F : -0.35F) + ((lane / 4) % 2 == 0 ? 0.35F : -0.35F);
      const float b = (lane % 2 == 0 ? 0.35F : -0.35F) - ((lane / 4) % 2 == 0 ? 0.35F : -0.35F);
      towards = (sun + kSunRadius_rad * (a * sun_right + b * sun_up)).normalized();
    }
    // Crowns are coarse meshes: triangles closer than this to the hit cast no shadow on it.
    const float offset = hit.tag.part == Part::kLeaves ? 0.5F : 4e-3F;
    shadow.Set(lane, hit.position + 2e-3F * face, towards, offset, kFar);
  }
  const uint32_t in_fixed_shadow = world_.scene().Occluded(shadow);
  const uint32_t in_moving_shadow = moving.scene.Occluded(shadow);
  const uint32_t dark = in_fixed_shadow | in_moving_shadow;
  const uint32_t moved = on_moving | (in_moving_shadow & ~in_fixed_shadow);
  const float weight = 1.0F / static_cast<float>(grid_ * grid_);
  for (size_t lane = 0; lane < raytrace::kPacket; ++lane) {
    if (rays.valid[lane] == 0) continue;
    const int x = (tile_x * kTile + static_cast<int>(lane) % kTile) / grid_;
    const int y = (tile_y * kTile + static_cast<int>(lane) / kTile) / grid_;
    Vector3f radiance;
    if (rays.triangle[lane] == raytrace::kNoTriangle) {
      radiance = world_.sky().Seen({rays.dx[lane], rays.dy[lane], rays.dz[lane]});
    } else {
      const Hit& hit = hits[lane];
      const Surface surface = ((on_moving >> lane) & 1U) != 0 ? World::MovingSurfaceAt(hit, moving.cars) : world_.SurfaceAt(hit);
      radiance = Shade(hit, surface, ((dark >> lane) & 1U) != 0 ? 0.0F : 1.0F);
    }
    float* pixel = out.rgb_linear.At(x, y);
    for (Eigen::Index c = 0; c < 3; ++c) pixel[c] += weight * radiance[c];
    if (((moved >> lane) & 1U) != 0) {
      *out.usable.At(x, y) = 0;
      row_masked[static_cast<size_t>(tile_y)] = 1;
    }
  }
}

Rendering PhotoRenderer::Render(const geo::Rigid3d& cam_from_enu, const MovingScene& moving, base::ThreadPool& threads,
                                const std::function<void(double share)>& advance) const {
  Rendering out;
  out.rgb_linear = image::ImageF(camera_.width, camera_.height, 3);
  out.usable = image::Image8(camera_.width, camera_.height, 1, 255);
  const Frame frame{cam_from_enu.OriginInSource().cast<float>(), cam_from_enu.rotation.conjugate().toRotationMatrix().cast<float>()};
  const int tiles_x = (camera_.width * grid_ + kTile - 1) / kTile;
  const int tiles_y = (camera_.height * grid_ + kTile - 1) / kTile;
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
  SurfaceImages out{image::ImageF(camera_.width, camera_.height, 1, kNan), image::ImageF(camera_.width, camera_.height, 3, kNan),
                    image::Image8(camera_.width, camera_.height, 1, static_cast<uint8_t>(survey::SurfaceClass::kNone))};
  const Vector3f origin = cam_from_enu.OriginInSource().cast<float>();
  const Eigen::Matrix3d enu_from_cam = cam_from_enu.rotation.conjugate().toRotationMatrix();
  const int packet = static_cast<int>(raytrace::kPacket);
  threads.ParallelFor(camera_.height, [&](int64_t row, int /*thread*/) {
    const int y = static_cast<int>(row);
    raytrace::RayPacket rays;
    std::array<double, raytrace::kPacket> z_per_metre{};
    for (int begin = 0; begin < camera_.width; begin += packet) {
      const int n = std::min(packet, camera_.width - begin);
      for (int lane = 0; lane < packet; ++lane) {
        const auto slot = static_cast<size_t>(lane);
        const Eigen::Vector3d in_cam = camera_.RayFromImg({std::min(begin + lane, camera_.width - 1) + 0.5, y + 0.5});
        z_per_metre[slot] = in_cam.z();
        rays.Set(slot, origin, (enu_from_cam * in_cam).cast<float>(), 0.1F, kFar);
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
        const survey::SurfaceClass seen =
            moves ? survey::SurfaceClass::kMovingCar : ClassOf(mesh.tag[triangle], origin + rays.t_far[slot] * direction, world_.city());
        *out.z_depth.At(x, y) = static_cast<float>(z_per_metre[slot] * static_cast<double>(rays.t_far[slot]));
        std::copy_n(normal.data(), 3, out.normals.At(x, y));
        *out.classes.At(x, y) = static_cast<uint8_t>(seen);
      }
    }
  });
  return out;
}

}  // namespace skyquilt::simulate
