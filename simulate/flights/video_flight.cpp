#include "simulate/flights/video_flight.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/survey/exif.h"
#include "simulate/survey_writer.h"

namespace skyquilt::simulate {
namespace {

constexpr double kTurn_degps = 45.0;
constexpr double kShortestWay_s = 0.1;

double AngleBetween_deg(double from_deg, double to_deg) {
  return std::remainder(to_deg - from_deg, 360.0);
}

double WayTime_s(const PlaceSpec& place, const PhotoPlan& from, const PhotoPlan& to) {
  const double way_m = (to.cam_from_enu.OriginInSource() - from.cam_from_enu.OriginInSource()).norm();
  const double turn_deg = std::max(std::abs(AngleBetween_deg(from.yaw_deg, to.yaw_deg)), std::abs(to.pitch_deg - from.pitch_deg));
  return std::max({kShortestWay_s, way_m / place.speed_mps, turn_deg / kTurn_degps});
}

PhotoPlan FrameBetween(const PhotoPlan& from, const PhotoPlan& to, double share) {
  PhotoPlan frame = share < 0.5 ? from : to;
  const auto between = [share](const auto& a, const auto& b) { return a + share * (b - a); };
  frame.yaw_deg = from.yaw_deg + share * AngleBetween_deg(from.yaw_deg, to.yaw_deg);
  frame.pitch_deg = between(from.pitch_deg, to.pitch_deg);
  frame.roll_deg = between(from.roll_deg, to.roll_deg);
  const Eigen::Vector3d a = from.cam_from_enu.OriginInSource(), b = to.cam_from_enu.OriginInSource();
  const Eigen::Vector3d position = a + share * (b - a);
  frame.cam_from_enu = PoseFromGimbal(position, frame.yaw_deg, frame.pitch_deg, frame.roll_deg);
  const Eigen::Vector3d tagged_a = from.tagged_position, tagged_b = to.tagged_position;
  frame.tagged_position = tagged_a + share * (tagged_b - tagged_a);
  frame.relative_altitude_m = between(from.relative_altitude_m, to.relative_altitude_m);
  if (from.tagged_gimbal && to.tagged_gimbal) {
    frame.tagged_gimbal = GimbalAngles{from.tagged_gimbal->yaw_deg + share * AngleBetween_deg(from.tagged_gimbal->yaw_deg, to.tagged_gimbal->yaw_deg),
                                       between(from.tagged_gimbal->pitch_deg, to.tagged_gimbal->pitch_deg),
                                       between(from.tagged_gimbal->roll_deg, to.tagged_gimbal->roll_deg)};
  }
  return frame;
}

// 00:01:02,400
std::string CueTime(double time_s) {
  const auto ms = std::llround(1000.0 * time_s);
  return fmt::format("{:02d}:{:02d}:{:02d},{:03d}", ms / 3'600'000, ms / 60'000 % 60, ms / 1000 % 60, ms % 1000);
}

// 2026-05-04 10:00:00.200
std::string ClockText(double clock_s) {
  const auto ms = std::llround(1000.0 * clock_s);
  const std::chrono::sys_time<std::chrono::milliseconds> time{std::chrono::milliseconds(ms)};
  const auto day = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day date(day);
  const auto of_day = std::chrono::duration_cast<std::chrono::milliseconds>(time - day).count();
  return fmt::format("{:04d}-{:02d}-{:02d} {:02d}:{:02d}:{:02d}.{:03d}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()), of_day / 3'600'000, of_day / 60'000 % 60, of_day / 1000 % 60, of_day % 1000);
}

}  // namespace

std::vector<PhotoPlan> PlanVideo(const PlaceSpec& place, const std::vector<PhotoPlan>& photos, int fps) {
  SKYQUILT_CHECK(fps > 0, std::to_string(fps));
  std::vector<PhotoPlan> frames;
  double way_begin_s = 0.0;
  for (size_t i = 0; i + 1 < photos.size(); ++i) {
    const double way_s = WayTime_s(place, photos[i], photos[i + 1]);
    while (static_cast<double>(frames.size()) / fps < way_begin_s + way_s) {
      const double time_s = static_cast<double>(frames.size()) / fps;
      frames.push_back(FrameBetween(photos[i], photos[i + 1], std::clamp((time_s - way_begin_s) / way_s, 0.0, 1.0)));
      frames.back().time_s = time_s;
    }
    way_begin_s += way_s;
  }
  return frames;
}

void WriteSubtitles(const std::vector<PhotoPlan>& frames, int fps, const camera::Camera& camera, const geo::EnuFrame& frame,
                    const std::filesystem::path& file) {
  std::string text;
  for (size_t i = 0; i < frames.size(); ++i) {
    const survey::PhotoTags tags = MakeTags(frames[i], camera, frame);
    text += fmt::format("{}\n{} --> {}\n<font size=\"28\">FrameCnt: {}, DiffTime: {}ms\n{}\n", i + 1, CueTime(frames[i].time_s),
                        CueTime(frames[i].time_s + 1.0 / fps), i + 1, 1000 / fps, ClockText(*tags.capture_time_s));
    if (tags.exposure.time_s) {
      text += fmt::format("[iso: {:.0f}] [shutter: 1/{:.1f}] [fnum: {:.1f}] [ev: 0] ", *tags.exposure.iso, 1.0 / *tags.exposure.time_s,
                          *tags.exposure.f_number);
    }
    text += fmt::format("[focal_len: {:.2f}] ", 36.0 * camera.FocalX() / camera.width);
    if (tags.gps) text += fmt::format("[latitude: {:.6f}] [longitude: {:.6f}] ", tags.gps->latitude_deg, tags.gps->longitude_deg);
    if (tags.relative_altitude_m) text += fmt::format("[rel_alt: {:.3f} abs_alt: {:.3f}] ", *tags.relative_altitude_m, *tags.absolute_altitude_m);
    if (tags.gimbal_pitch_deg) {
      text += fmt::format("[gb_yaw: {:.1f} gb_pitch: {:.1f} gb_roll: {:.1f}] ", *tags.gimbal_yaw_deg, *tags.gimbal_pitch_deg, *tags.gimbal_roll_deg);
    }
    text += "</font>\n\n";
  }
  base::WriteFileAtomically(file, text);
}

void WriteVideoPoses(const std::vector<PhotoPlan>& frames, const std::filesystem::path& file) {
  std::string text = "frame,time_s,rotation_w,rotation_x,rotation_y,rotation_z,translation_x_m,translation_y_m,translation_z_m\n";
  for (size_t i = 0; i < frames.size(); ++i) {
    const Eigen::Quaterniond& r = frames[i].cam_from_enu.rotation;
    const Eigen::Vector3d& t = frames[i].cam_from_enu.translation;
    text += fmt::format("{},{:.3f},{:.9f},{:.9f},{:.9f},{:.9f},{:.6f},{:.6f},{:.6f}\n", i, frames[i].time_s, r.w(), r.x(), r.y(), r.z(), t.x(), t.y(),
                        t.z());
  }
  base::WriteFileAtomically(file, text);
}

}  // namespace skyquilt::simulate
