#include "simulate/ray_shader.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "core/base/errors.h"

namespace skyquilt::simulate {
namespace {

using Eigen::Vector3f;

constexpr float kSunRadius_rad = 0.00465F;

}  // namespace

int SamplesPerSide(int samples) {
  const int side = samples == 16 ? 4 : (samples == 4 ? 2 : 1);
  SKYQUILT_CHECK(samples == side * side, std::to_string(samples) + " samples per pixel");
  return side;
}

Vector3f RayShader::Shade(const Hit& hit, const Surface& surface, float sun_share) const {
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

RayLight RayShader::Trace(const MovingScene& moving, const PixelWidth& pixel, raytrace::RayPacket& rays) const {
  world_.scene().Intersect(rays);
  const uint32_t on_moving = moving.scene.Intersect(rays);
  std::array<Hit, raytrace::kPacket> hits;
  raytrace::RayPacket shadow;
  shadow.valid.fill(0);
  const Vector3f& sun = world_.sky().sun_direction();
  const Vector3f sun_right = sun.unitOrthogonal();
  const Vector3f sun_up = sun.cross(sun_right);
  for (size_t lane = 0; lane < raytrace::kPacket; ++lane) {
    if (rays.valid[lane] == 0 || rays.triangle[lane] == raytrace::kNoTriangle) continue;
    const Mesh& mesh = ((on_moving >> lane) & 1U) != 0 ? moving.mesh : world_.mesh();
    Hit& hit = hits[lane];
    hit.direction = {rays.dx[lane], rays.dy[lane], rays.dz[lane]};
    hit.position = Vector3f(rays.ox[lane], rays.oy[lane], rays.oz[lane]) + rays.t_far[lane] * hit.direction;
    hit.tag = mesh.tag[rays.triangle[lane]];
    hit.footprint_m = pixel.at_start_m + rays.t_far[lane] * pixel.per_metre;
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
    shadow.Set(lane, hit.position + 2e-3F * face, towards, offset, kFarthestHit_m);
  }
  const uint32_t in_fixed_shadow = world_.scene().Occluded(shadow);
  const uint32_t in_moving_shadow = moving.scene.Occluded(shadow);
  const uint32_t dark = in_fixed_shadow | in_moving_shadow;
  RayLight light;
  light.moved = on_moving | (in_moving_shadow & ~in_fixed_shadow);
  for (size_t lane = 0; lane < raytrace::kPacket; ++lane) {
    if (rays.valid[lane] == 0) continue;
    if (rays.triangle[lane] == raytrace::kNoTriangle) {
      light.radiance[lane] = world_.sky().Seen({rays.dx[lane], rays.dy[lane], rays.dz[lane]});
    } else {
      const Hit& hit = hits[lane];
      const Surface surface = ((on_moving >> lane) & 1U) != 0 ? World::MovingSurfaceAt(hit, moving) : world_.SurfaceAt(hit);
      light.radiance[lane] = Shade(hit, surface, ((dark >> lane) & 1U) != 0 ? 0.0F : moving.clouds.SunShare(hit.position));
    }
  }
  return light;
}

}  // namespace skyquilt::simulate
