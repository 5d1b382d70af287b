#include "prepare/video/track_motion.h"

#include <cmath>
#include <numbers>

namespace skyquilt::prepare::video {
namespace {

constexpr double kUsualFocal_mm = 24.0, kFilmWidth_mm = 36.0;
constexpr double kLeastHeight_m = 5.0, kLevelPitch_deg = -45.0;
constexpr double kMetresPerDegree = 111'320.0;

double ToRadians(double deg) {
  return deg * std::numbers::pi / 180.0;
}

bool IsUsable(const TrackPoint& state) {
  return state.latitude_deg && state.relative_altitude_m && *state.relative_altitude_m >= kLeastHeight_m && state.gimbal_yaw_deg &&
         state.gimbal_pitch_deg && *state.gimbal_pitch_deg <= kLevelPitch_deg && *state.gimbal_pitch_deg >= -135.0;
}

double DistanceOf(const TrackPoint& state) {
  return *state.relative_altitude_m / std::sin(-ToRadians(*state.gimbal_pitch_deg));
}

FrameShift Step(const TrackPoint& from, const TrackPoint& to) {
  const double focal = from.focal_35mm.value_or(kUsualFocal_mm) / kFilmWidth_mm;  // in widths of the frame
  const double latitude = ToRadians(*from.latitude_deg);
  const double north_m = (*to.latitude_deg - *from.latitude_deg) * kMetresPerDegree;
  const double east_m = std::remainder(*to.longitude_deg - *from.longitude_deg, 360.0) * kMetresPerDegree * std::cos(latitude);
  const double yaw = ToRadians(*from.gimbal_yaw_deg), pitch = ToRadians(*from.gimbal_pitch_deg);
  const double ahead_m = std::sin(yaw) * east_m + std::cos(yaw) * north_m, right_m = std::cos(yaw) * east_m - std::sin(yaw) * north_m;
  const double turn = ToRadians(std::remainder(*to.gimbal_yaw_deg - *from.gimbal_yaw_deg, 360.0));
  const double tilt = ToRadians(*to.gimbal_pitch_deg - *from.gimbal_pitch_deg);
  const double distance_m = DistanceOf(from), scale = distance_m / DistanceOf(to);
  // A camera that turns to the right turns the picture to the left, the more the steeper it looks down, and moves it to the left otherwise.
  const double turned = -turn * std::sin(-pitch);
  return {.a = scale * std::cos(turned),
          .b = scale * std::sin(turned),
          .right = focal * (-right_m / distance_m - turn * std::cos(pitch)),
          .down = focal * (ahead_m * std::sin(-pitch) / distance_m + tilt)};
}

}  // namespace

std::optional<std::vector<FrameShift>> ShiftsByTrack(std::span<const TrackPoint> states) {
  std::vector<FrameShift> shifts;
  for (size_t i = 0; i < states.size(); ++i) {
    if (!IsUsable(states[i])) return std::nullopt;
    shifts.push_back(i == 0 ? FrameShift() : shifts.back().Then(Step(states[i - 1], states[i])));
  }
  return shifts;
}

}  // namespace skyquilt::prepare::video
