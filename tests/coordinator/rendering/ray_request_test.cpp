#include "coordinator/rendering/ray_request.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <stdexcept>

#include "core/base/random.h"
#include "products/ray_caster.h"

namespace skyquilt::coordinator {
namespace {

using render::Ray;
using scene::RayInFlight;

RayRequest Request(int n, bool one_camera, bool fresh, uint64_t seed, bool normals = false) {
  base::Random random(seed);
  RayRequest request{
      .id = seed, .options = {.step_scale = 2.0, .normals = normals, .concealing = render::Concealing::kGain}, .rays = {}, .in_flight = {}};
  for (int i = 0; i < n; ++i) {
    Ray ray;
    ray.origin_enu = one_camera ? Eigen::Vector3d(1.0, 2.0, 3.0) : Eigen::Vector3d{random.Normal(), random.Normal(), random.Normal()};
    ray.direction_enu = {random.Normal(), random.Normal(), random.Normal()};
    ray.pixel_pitch = 0.001F * random.Uniform();  // differs within a photo
    ray.pixel_width = one_camera ? 0.25F : random.Uniform();
    request.rays.push_back(ray);
    RayInFlight ray_in_flight;
    if (!fresh) {
      ray_in_flight.at = random.Uniform(0.1, 9.0);
      ray_in_flight.state.transmittance = 0.5;
      ray_in_flight.state.rgb_srgb[1] = 0.25F;
      ray_in_flight.state.depth_front = 4.0F;
      ray_in_flight.state.light_passed = 0.75F;
      ray_in_flight.owner = i % 3;
      if (normals) ray_in_flight.state.density_normal[2] = ray_in_flight.state.predicted_normal[0] = random.Uniform();
    }
    request.in_flight.push_back(ray_in_flight);
  }
  return request;
}

RC_GTEST_PROP(RayRequestProperty, ReadsBackUnchanged, ()) {
  const RayRequest sent = Request(*rc::gen::inRange(0, 20), *rc::gen::arbitrary<bool>(), *rc::gen::arbitrary<bool>(),
                                  *rc::gen::inRange<uint64_t>(1, 99), *rc::gen::arbitrary<bool>());
  const RayRequest got = RayRequestFromBytes(ToBytes(sent));
  RC_ASSERT(got.id == sent.id);
  RC_ASSERT(got.options.step_scale == sent.options.step_scale);
  RC_ASSERT(got.options.colour_threshold == sent.options.colour_threshold);
  RC_ASSERT(got.options == sent.options);
  RC_ASSERT(got.rays.size() == sent.rays.size());
  for (size_t i = 0; i < sent.rays.size(); ++i) {
    RC_ASSERT(got.rays[i].origin_enu == sent.rays[i].origin_enu);
    RC_ASSERT(got.rays[i].direction_enu == sent.rays[i].direction_enu);
    RC_ASSERT(got.rays[i].t_near == sent.rays[i].t_near);
    RC_ASSERT(got.rays[i].t_far == sent.rays[i].t_far);
    RC_ASSERT(got.rays[i].pixel_pitch == sent.rays[i].pixel_pitch);
    RC_ASSERT(got.rays[i].pixel_width == sent.rays[i].pixel_width);
    RC_ASSERT(got.in_flight[i].at == sent.in_flight[i].at);
    RC_ASSERT(got.in_flight[i].state.transmittance == sent.in_flight[i].state.transmittance);
    RC_ASSERT(got.in_flight[i].state.rgb_srgb[1] == sent.in_flight[i].state.rgb_srgb[1]);
    RC_ASSERT(got.in_flight[i].state.density_normal[2] == sent.in_flight[i].state.density_normal[2]);
    RC_ASSERT(got.in_flight[i].state.predicted_normal[0] == sent.in_flight[i].state.predicted_normal[0]);
    RC_ASSERT(got.in_flight[i].state.light_passed == sent.in_flight[i].state.light_passed);
    RC_ASSERT(std::isnan(sent.in_flight[i].state.depth_front) || got.in_flight[i].state.depth_front == sent.in_flight[i].state.depth_front);
  }
}

RC_GTEST_PROP(RayReplyProperty, ReadsBackUnchanged, ()) {
  RayReply sent{.id = 7, .samples = 123, .field_loads = 4, .in_flight = {}, .colors = {}, .failure = {Failure::kInput, "why", "scene.h5"}};
  const int n = *rc::gen::inRange(0, 20);
  const bool normals = *rc::gen::arbitrary<bool>();
  for (int i = 0; i < n; ++i) {
    RayInFlight ray_in_flight;
    ray_in_flight.owner = *rc::gen::inRange(-1, 3);
    ray_in_flight.at = i;
    if (normals) ray_in_flight.state.density_normal[0] = 0.5F;
    sent.in_flight.push_back(ray_in_flight);
    if (ray_in_flight.owner == scene::kFinished) sent.colors.push_back({.opacity = 0.01F * static_cast<float>(i)});
    if (normals && !sent.colors.empty()) sent.colors.back().predicted_normal[1] = 0.25F;
  }
  const RayReply got = RayReplyFromBytes(ToBytes(sent));
  RC_ASSERT(got.id == 7U && got.samples == 123 && got.field_loads == 4 && got.failure.kind == Failure::kInput && got.failure.reason == "why" &&
            got.failure.file == "scene.h5");
  RC_ASSERT(got.in_flight.size() == sent.in_flight.size() && got.colors.size() == sent.colors.size());
  for (size_t i = 0; i < sent.in_flight.size(); ++i) {
    RC_ASSERT(got.in_flight[i].owner == sent.in_flight[i].owner);
    if (sent.in_flight[i].owner != scene::kFinished) {
      RC_ASSERT(got.in_flight[i].state.density_normal[0] == sent.in_flight[i].state.density_normal[0]);
    }
  }
  for (size_t i = 0; i < sent.colors.size(); ++i) {
    RC_ASSERT(got.colors[i].opacity == sent.colors[i].opacity);
    RC_ASSERT(got.colors[i].predicted_normal[1] == sent.colors[i].predicted_normal[1]);
  }
}

TEST(RayRequest, RaysOfOneCameraAreSmall) {
  const size_t of_camera = ToBytes(Request(1000, true, true, 1)).size();
  EXPECT_LT(of_camera, 1000U * 28U + 200U);
  EXPECT_GT(ToBytes(Request(1000, false, false, 1)).size(), 3 * of_camera);
}

TEST(RayRequest, RefusesOtherBytes) {
  const std::string good = ToBytes(Request(5, false, false, 2));
  for (size_t n = 0; n < good.size(); ++n) EXPECT_THROW(RayRequestFromBytes(good.substr(0, n)), std::runtime_error) << n;
  EXPECT_THROW(RayRequestFromBytes(good + "x"), std::runtime_error);
  std::string many = good;
  // The number of rays comes after id, options and two flags.
  for (size_t i = 0; i < 8; ++i) many[8 + 8 + 4 + sizeof(render::Concealing) + 3 + i] = '\x7f';
  EXPECT_THROW(RayRequestFromBytes(many), std::runtime_error);
}

// A rank has one request that it renders and the next one.
RC_GTEST_PROP(RaysPerRequestProperty, MapsKeepEveryRankBusy, ()) {
  const int ranks = *rc::gen::inRange(1, 513);
  const size_t rays = products::RaysPerCall(ranks);
  RC_ASSERT(rays / RaysPerRequest(rays, ranks) >= 2 * static_cast<size_t>(ranks));
}

RC_GTEST_PROP(RaysPerRequestProperty, SmallPicturesAreSharedToo, ()) {
  const int ranks = *rc::gen::inRange(1, 65);
  const auto rays = *rc::gen::inRange<size_t>(0, 3'000'000);
  const size_t each = RaysPerRequest(rays, ranks);
  RC_ASSERT(each >= 512U && each <= 16'384U);
  if (rays >= 4U * 512U * static_cast<size_t>(ranks)) RC_ASSERT(rays / each >= 4U * static_cast<size_t>(ranks));
}

}  // namespace
}  // namespace skyquilt::coordinator
