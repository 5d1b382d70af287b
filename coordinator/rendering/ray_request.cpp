#include "coordinator/rendering/ray_request.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "core/base/json_text.h"
#include "core/base/packed_bytes.h"

namespace skyquilt::coordinator {
namespace {

static_assert(std::is_trivially_copyable_v<scene::RayInFlight> && std::is_trivially_copyable_v<render::RayColor> &&
              std::is_trivially_copyable_v<render::EngineOptions>);

Failure TakeFailure(base::ByteUnpacker* unpacker) {
  try {
    return FailureFromJson(base::ParseJson(unpacker->Take<std::string>()));
  } catch (const nlohmann::json::exception&) {
    unpacker->Fail();
  }
}

base::ByteUnpacker UnpackerOf(const std::string& bytes) {
  return {bytes, "a message with rays cannot be read. Make sure that all ranks run the same version of skyquilt"};
}

struct Common {
  double origin[3];
  double t_near, t_far;
  float pixel_width;
};

Common CommonOf(const render::Ray& ray) {
  return {{ray.origin_enu.x(), ray.origin_enu.y(), ray.origin_enu.z()}, ray.t_near, ray.t_far, ray.pixel_width};
}

bool Same(const render::Ray& a, const render::Ray& b) {
  return a.origin_enu == b.origin_enu && a.t_near == b.t_near && a.t_far == b.t_far && a.pixel_width == b.pixel_width;
}

bool Fresh(const scene::RayInFlight& ray_in_flight) {
  return ray_in_flight.at == 0.0 && ray_in_flight.state.transmittance == 1.0 && !ray_in_flight.state.ended;
}

// Normals are sent only in messages that have any: they would make each ray half as large again.
template <typename Rendered>
bool HasNormals(const Rendered& ray) {
  const auto any = [](const float(&n)[3]) { return n[0] != 0.0F || n[1] != 0.0F || n[2] != 0.0F; };
  return any(ray.density_normal) || any(ray.predicted_normal);
}

// Member by member, because the padding bytes of the struct are not initialised.
void AddRayInFlight(const scene::RayInFlight& ray_in_flight, bool normals, base::BytePacker* packer) {
  const render::RayState& s = ray_in_flight.state;
  packer->Add(s.transmittance);
  packer->Add(s.depth_moment);
  packer->Add(s.rgb_srgb);
  packer->Add(s.concealed_light);
  packer->Add(s.light_passed);
  packer->Add(s.depth_front);
  packer->Add(s.depth_median);
  packer->Add(s.depth_back);
  packer->Add(s.ended);
  packer->Add(ray_in_flight.at);
  packer->Add(ray_in_flight.owner);
  if (!normals) return;
  packer->Add(s.density_normal);
  packer->Add(s.predicted_normal);
}

scene::RayInFlight TakeRayInFlight(bool normals, base::ByteUnpacker* unpacker) {
  scene::RayInFlight ray_in_flight;
  render::RayState& s = ray_in_flight.state;
  s.transmittance = unpacker->Take<double>();
  s.depth_moment = unpacker->Take<double>();
  unpacker->Take(&s.rgb_srgb);
  unpacker->Take(&s.concealed_light);
  s.light_passed = unpacker->Take<float>();
  s.depth_front = unpacker->Take<float>();
  s.depth_median = unpacker->Take<float>();
  s.depth_back = unpacker->Take<float>();
  s.ended = unpacker->Take<bool>();
  ray_in_flight.at = unpacker->Take<double>();
  ray_in_flight.owner = unpacker->Take<int>();
  if (normals) {
    unpacker->Take(&s.density_normal);
    unpacker->Take(&s.predicted_normal);
  }
  return ray_in_flight;
}

// The members before the normals, which are the last.
constexpr size_t kColorBytes = offsetof(render::RayColor, density_normal);
static_assert(sizeof(render::RayColor) == kColorBytes + 6 * sizeof(float));

void AddColor(const render::RayColor& color, bool normals, base::BytePacker* packer) {
  std::array<char, kColorBytes> without_normals;
  std::memcpy(without_normals.data(), &color, kColorBytes);
  packer->Add(without_normals);
  if (!normals) return;
  packer->Add(color.density_normal);
  packer->Add(color.predicted_normal);
}

render::RayColor TakeColor(bool normals, base::ByteUnpacker* unpacker) {
  render::RayColor color;
  const auto without_normals = unpacker->Take<std::array<char, kColorBytes>>();
  std::memcpy(static_cast<void*>(&color), without_normals.data(), kColorBytes);
  if (normals) {
    unpacker->Take(&color.density_normal);
    unpacker->Take(&color.predicted_normal);
  }
  return color;
}

}  // namespace

std::string ToBytes(const RayRequest& request) {
  base::BytePacker packer;
  packer.Add(request.id);
  packer.Add(request.options.step_scale);
  packer.Add(request.options.colour_threshold);
  packer.Add(request.options.end_transmittance);
  packer.Add(request.options.concealing);
  packer.Add(request.options.normals);
  const auto& rays = request.rays;
  const bool shared = std::all_of(rays.begin(), rays.end(), [&](const render::Ray& ray) { return Same(ray, rays.front()); });
  const bool fresh = std::all_of(request.in_flight.begin(), request.in_flight.end(), Fresh);
  packer.Add(shared);
  packer.Add(fresh);
  packer.AddCount(rays.size());
  if (shared && !rays.empty()) packer.Add(CommonOf(rays.front()));
  for (const render::Ray& ray : rays) {
    for (int axis = 0; axis < 3; ++axis) packer.Add(ray.direction_enu[axis]);
    packer.Add(ray.pixel_pitch);
    if (!shared) packer.Add(CommonOf(ray));
  }
  if (!fresh) {
    for (const scene::RayInFlight& ray_in_flight : request.in_flight) AddRayInFlight(ray_in_flight, request.options.normals, &packer);
  }
  return packer.Take();
}

RayRequest RayRequestFromBytes(const std::string& bytes) {
  base::ByteUnpacker unpacker = UnpackerOf(bytes);
  RayRequest request;
  request.id = unpacker.Take<uint64_t>();
  request.options.step_scale = unpacker.Take<double>();
  request.options.colour_threshold = unpacker.Take<float>();
  request.options.end_transmittance = unpacker.Take<double>();
  request.options.concealing = unpacker.Take<render::Concealing>();
  request.options.normals = unpacker.Take<bool>();
  const bool shared = unpacker.Take<bool>();
  const bool fresh = unpacker.Take<bool>();
  const size_t n = unpacker.TakeCount(3 * sizeof(double));
  Common common{};
  if (shared && n > 0) common = unpacker.Take<Common>();
  for (size_t i = 0; i < n; ++i) {
    render::Ray ray;
    for (int axis = 0; axis < 3; ++axis) ray.direction_enu[axis] = unpacker.Take<double>();
    ray.pixel_pitch = unpacker.Take<float>();
    if (!shared) common = unpacker.Take<Common>();
    ray.origin_enu = {common.origin[0], common.origin[1], common.origin[2]};
    ray.t_near = common.t_near;
    ray.t_far = common.t_far;
    ray.pixel_width = common.pixel_width;
    request.rays.push_back(ray);
  }
  request.in_flight.resize(n);
  if (!fresh) {
    for (scene::RayInFlight& ray_in_flight : request.in_flight) ray_in_flight = TakeRayInFlight(request.options.normals, &unpacker);
  }
  unpacker.End();
  return request;
}

std::string ToBytes(const RayReply& reply) {
  base::BytePacker packer;
  packer.Add(reply.id);
  packer.Add(reply.samples);
  packer.Add(reply.field_loads);
  packer.Add(base::JsonText(ToJson(reply.failure)));
  const auto in_flight_normals = [](const scene::RayInFlight& ray_in_flight) { return HasNormals(ray_in_flight.state); };
  const bool normals = std::any_of(reply.in_flight.begin(), reply.in_flight.end(), in_flight_normals) ||
                       std::any_of(reply.colors.begin(), reply.colors.end(), HasNormals<render::RayColor>);
  packer.Add(normals);
  packer.AddCount(reply.in_flight.size());
  size_t color = 0;
  for (const scene::RayInFlight& ray_in_flight : reply.in_flight) {
    const bool arrived = ray_in_flight.owner == scene::kFinished;
    packer.Add(arrived);
    if (arrived) {
      AddColor(reply.colors.at(color++), normals, &packer);
    } else {
      AddRayInFlight(ray_in_flight, normals, &packer);
    }
  }
  return packer.Take();
}

RayReply RayReplyFromBytes(const std::string& bytes) {
  base::ByteUnpacker unpacker = UnpackerOf(bytes);
  RayReply reply;
  reply.id = unpacker.Take<uint64_t>();
  reply.samples = unpacker.Take<int64_t>();
  reply.field_loads = unpacker.Take<int64_t>();
  reply.failure = TakeFailure(&unpacker);
  const bool normals = unpacker.Take<bool>();
  const size_t n = unpacker.TakeCount(sizeof(bool));
  for (size_t i = 0; i < n; ++i) {
    scene::RayInFlight ray_in_flight;
    if (unpacker.Take<bool>()) {
      ray_in_flight.owner = scene::kFinished;
      reply.colors.push_back(TakeColor(normals, &unpacker));
    } else {
      ray_in_flight = TakeRayInFlight(normals, &unpacker);
    }
    reply.in_flight.push_back(ray_in_flight);
  }
  unpacker.End();
  return reply;
}

}  // namespace skyquilt::coordinator
