#include "worker/step/packet_context.h"

#include "core/render/march.h"

namespace skyquilt::worker {
namespace {

// tau of a block's samples beyond which the context behind is not rendered: less than 2 % of it would show through.
constexpr float kOpaqueTau = 4.0F;

}  // namespace

PacketContext::PacketContext(const PacketShared& shared)
    : shared_(shared), renderer_({{}, shared.context}, render::EngineOptions::For(shared.luminance)) {}

void PacketContext::Render(PacketSamples& s) {
  pieces_.clear();
  owner_.clear();
  for (size_t k = 0; k < s.views.size(); ++k) {
    if (!s.Ray(k).ray.empty) AddPieces(s, k);
  }
  colors_.resize(pieces_.size());
  renderer_.Render(pieces_, colors_);
  for (size_t i = 0; i < pieces_.size(); ++i) {
    RayView& view = s.views[owner_[i].first];
    const bool behind = owner_[i].second;
    for (size_t c = 0; c < 3; ++c) {
      (behind ? view.behind_rgb : view.front_rgb)[c] = colors_[i].rgb_srgb[c];
      (behind ? view.behind_light : view.front_light)[c] = colors_[i].concealed_light[c];
    }
    // Behind the context there is the random background colour.
    (behind ? view.background_share : view.front_transmittance) = 1.0F - colors_[i].opacity;
  }
}

void PacketContext::AddPieces(const PacketSamples& s, size_t view) {
  const PixelRay& ray = s.Ray(view).ray;
  const float pitch = shared_.context->config.Cones() ? ray.pixel_pitch : 0.0F;
  const geo::Interval all = render::FieldInterval(shared_.context->map, ray.origin_enu, ray.direction_enu);
  if (all.Empty()) return;
  const geo::Interval plan = render::PlanInterval(shared_.target.map, ray.origin_enu, ray.direction_enu);
  if (plan.t_near > all.t_near + shared_.context->step_m) {
    pieces_.push_back({ray.origin_enu, ray.direction_enu, all.t_near, plan.t_near, pitch});
    owner_.emplace_back(view, false);
  }
  float tau = 0.0F;
  for (int64_t i = 0; i < s.views[view].count; ++i) tau += s.tau[static_cast<size_t>(s.views[view].begin + i)];
  if (tau < kOpaqueTau && all.t_far > plan.t_far) {
    pieces_.push_back({ray.origin_enu, ray.direction_enu, plan.t_far, all.t_far, pitch});
    owner_.emplace_back(view, true);
  }
}

}  // namespace skyquilt::worker
