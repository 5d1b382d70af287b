#include "core/raytrace/traced_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <string>

#include "core/base/errors.h"

namespace skyquilt::raytrace {

namespace {

// One for the process, because Embree runs out of devices at about a thousand. Never released, because scenes may exist until the program ends.
RTCDevice Device() {
  static RTCDevice device = rtcNewDevice("threads=1");
  SKYQUILT_CHECK(device != nullptr, "Embree error " + std::to_string(rtcGetDeviceError(nullptr)));
  return device;
}

RTCIntersectContext CoherentContext() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  return context;
}

void SetRays(const RayPacket& rays, RTCRay16& packet) {
  for (size_t i = 0; i < kPacket; ++i) {
    packet.org_x[i] = rays.ox[i];
    packet.org_y[i] = rays.oy[i];
    packet.org_z[i] = rays.oz[i];
    packet.dir_x[i] = rays.dx[i];
    packet.dir_y[i] = rays.dy[i];
    packet.dir_z[i] = rays.dz[i];
    packet.tnear[i] = rays.t_near[i];
    packet.tfar[i] = rays.t_far[i];
    packet.time[i] = 0.0F;
    packet.mask[i] = 0xffffffffU;
    packet.id[i] = 0;
    packet.flags[i] = 0;
  }
}

}  // namespace

struct TracedScene::Impl {
  RTCScene scene = nullptr;
  ~Impl() {
    if (scene != nullptr) rtcReleaseScene(scene);
  }
};

void RayPacket::Set(size_t lane, const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near_m, float far_m) {
  ox[lane] = origin.x();
  oy[lane] = origin.y();
  oz[lane] = origin.z();
  dx[lane] = direction.x();
  dy[lane] = direction.y();
  dz[lane] = direction.z();
  t_near[lane] = near_m;
  t_far[lane] = far_m;
  u[lane] = 0.0F;
  v[lane] = 0.0F;
  triangle[lane] = kNoTriangle;
  valid[lane] = -1;
}

TracedScene::TracedScene(std::span<const Eigen::Vector3f> position, std::span<const std::array<uint32_t, 3>> triangle)
    : impl_(std::make_unique<Impl>()), empty_(triangle.empty()) {
  if (empty_) return;
  const RTCDevice device = Device();
  rtcGetDeviceError(device);  // clears an earlier error of this thread
  impl_->scene = rtcNewScene(device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* vertex =
      static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), position.size()));
  auto* index =
      static_cast<uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(uint32_t), triangle.size()));
  SKYQUILT_CHECK(vertex != nullptr && index != nullptr, "Embree has no memory for the scene");
  for (const Eigen::Vector3f& p : position) vertex = std::copy(p.data(), p.data() + 3, vertex);
  for (const auto& corner : triangle) index = std::copy(corner.begin(), corner.end(), index);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(impl_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(impl_->scene);
  const RTCError error = rtcGetDeviceError(device);
  SKYQUILT_CHECK(error == RTC_ERROR_NONE, "Embree error " + std::to_string(error));
}

TracedScene::~TracedScene() = default;
TracedScene::TracedScene(TracedScene&&) noexcept = default;
TracedScene& TracedScene::operator=(TracedScene&&) noexcept = default;

uint32_t TracedScene::Intersect(RayPacket& rays) const {
  if (empty_) return 0;
  RTCIntersectContext context = CoherentContext();
  alignas(64) RTCRayHit16 packet;
  SetRays(rays, packet.ray);
  for (size_t i = 0; i < kPacket; ++i) {
    packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  rtcIntersect16(rays.valid.data(), impl_->scene, &context, &packet);
  uint32_t changed = 0;
  for (size_t i = 0; i < kPacket; ++i) {
    if (rays.valid[i] == 0 || packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    rays.t_far[i] = packet.ray.tfar[i];
    rays.u[i] = packet.hit.u[i];
    rays.v[i] = packet.hit.v[i];
    rays.triangle[i] = packet.hit.primID[i];
    changed |= 1U << i;
  }
  return changed;
}

uint32_t TracedScene::Occluded(const RayPacket& rays) const {
  if (empty_) return 0;
  RTCIntersectContext context = CoherentContext();
  alignas(64) RTCRay16 packet;
  SetRays(rays, packet);
  rtcOccluded16(rays.valid.data(), impl_->scene, &context, &packet);
  uint32_t occluded = 0;
  for (size_t i = 0; i < kPacket; ++i) {
    if (rays.valid[i] != 0 && packet.tfar[i] < 0.0F) occluded |= 1U << i;
  }
  return occluded;
}

}  // namespace skyquilt::raytrace
