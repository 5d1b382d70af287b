#include <algorithm>
#include <cmath>

#include "viewer/protocol/replies.h"
#include "viewer/queries/field_rays.h"

namespace skyquilt::viewer {
namespace {

// Orthographic pictures also show what lies behind the eye, so the ray of one of their pixels begins before the scene's box.
double StartsBehind(const PickRequest& request, const FieldAccess& access) {
  if (request.pixel_pitch > 0.0 || request.pixel_width_m <= 0.0) return 0.0;
  const bool before = request.project == Which::kBefore;
  const Eigen::Vector3d &min_enu = before ? access.before_min_enu : access.min_enu, &max_enu = before ? access.before_max_enu : access.max_enu;
  const Eigen::Array3d low = min_enu.array() - request.origin_enu.array(), high = max_enu.array() - request.origin_enu.array();
  const Eigen::Array3d nearest = (low * request.direction_enu.array()).min(high * request.direction_enu.array());
  const double behind = -nearest.sum() + 0.05 * (max_enu - min_enu).norm();
  return std::isfinite(behind) ? std::max(0.0, behind) : 0.0;
}

// One ray. Its surface is where the transmittance falls below one half, as in exact frames and their depth.
class PickQuery : public Query {
 public:
  explicit PickQuery(const PickRequest& request) : request_(request) {}

  bool Step(const FieldAccess& access) override {
    const RayCaster& caster = CasterFor(access, request_.project);
    const double behind = StartsBehind(request_, access);
    const render::Ray ray{.origin_enu = request_.origin_enu - behind * request_.direction_enu,
                          .direction_enu = request_.direction_enu,
                          .pixel_pitch = static_cast<float>(request_.pixel_pitch),
                          .pixel_width = static_cast<float>(request_.pixel_width_m)};
    render::RayColor color;
    caster({&ray, 1}, {&color, 1});
    const auto depth = static_cast<double>(color.depth_median);
    point_.opacity = static_cast<double>(color.opacity);
    point_.hit = std::isfinite(depth);
    if (point_.hit) {
      point_.point_enu = ray.origin_enu + depth * ray.direction_enu;
      point_.depth_m = depth - behind;
      point_.spread_m = DepthSpread(color);
    }
    done_ = true;
    return true;
  }
  double fraction() const override { return done_ ? 1.0 : 0.0; }
  std::string Reply() const override { return PickedText(request_.id, point_); }

 private:
  const PickRequest request_;
  SurfacePoint point_;
  bool done_ = false;
};

}  // namespace

std::unique_ptr<Query> MakePick(const PickRequest& request) {
  return std::make_unique<PickQuery>(request);
}

}  // namespace skyquilt::viewer
