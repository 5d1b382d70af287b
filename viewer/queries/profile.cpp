#include <algorithm>
#include <limits>

#include "viewer/protocol/replies.h"
#include "viewer/queries/field_rays.h"

namespace skyquilt::viewer {
namespace {

class ProfileQuery : public Query {
 public:
  explicit ProfileQuery(const ProfileRequest& request)
      : request_(request),
        length_m_((request.to_enu - request.from_enu).norm()),
        heights_m_(static_cast<size_t>(std::max(2, request.samples)), std::numeric_limits<double>::quiet_NaN()),
        spreads_m_(heights_m_) {}

  bool Step(const FieldAccess& access) override {
    const RayCaster& caster = CasterFor(access, request_.project);
    const VerticalRays vertical(access);
    const auto gaps = static_cast<double>(heights_m_.size() - 1);
    // A sample stands for the ground up to the next one, but is not finer than what the photos show.
    const double width_m = std::min(length_m_ / gaps, GsdOf(access));
    done_ = CastSome(
        caster, access.batch, done_, heights_m_.size(),
        [&](size_t i) {
          const double share = static_cast<double>(i) / gaps;
          return vertical.At((1.0 - share) * request_.from_enu + share * request_.to_enu, width_m);
        },
        [&](size_t i, const render::RayColor& color) {
          heights_m_[i] = vertical.Height(color);
          spreads_m_[i] = DepthSpread(color);
        });
    return done_ == heights_m_.size();
  }
  double fraction() const override { return static_cast<double>(done_) / static_cast<double>(heights_m_.size()); }
  std::string Reply() const override { return ProfileText(request_.id, length_m_, heights_m_, spreads_m_); }

 private:
  const ProfileRequest request_;
  const double length_m_;
  std::vector<double> heights_m_, spreads_m_;
  size_t done_ = 0;
};

}  // namespace

std::unique_ptr<Query> MakeProfile(const ProfileRequest& request) {
  return std::make_unique<ProfileQuery>(request);
}

}  // namespace skyquilt::viewer
