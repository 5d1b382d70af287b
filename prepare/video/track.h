// Where a drone was while it filmed, and how its camera was set: from files beside the video. Readers: subtitles.h (DJI and others), gpx.h,
// csv_track.h.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::prepare::video {

// What a source says of one moment. Numbers that no drone can have are left out by the readers: every value here is finite, latitudes are within +-90
// degrees, longitudes within +-180, and both are known or none; lengths of time, ISO, f-numbers and focal lengths are above 0.
struct TrackPoint {
  double time_s = 0.0;                                                      // see FlightTrack::by_clock
  std::optional<double> latitude_deg, longitude_deg;                        // WGS84
  std::optional<double> altitude_m;                                         // above sea level, by the source
  std::optional<double> relative_altitude_m;                                // above take-off
  std::optional<double> gimbal_yaw_deg, gimbal_pitch_deg, gimbal_roll_deg;  // as DJI's XMP tags: yaw clockwise from north, pitch -90 looks down
  std::optional<double> exposure_time_s, f_number, iso;
  std::optional<double> focal_35mm;  // focal length for film of 35 mm
  std::optional<double> clock_s;     // the camera's clock, seconds since 1970
};

struct FlightTrack {
  std::filesystem::path file;
  std::string form;                     // for people: "DJI subtitles"
  std::vector<TrackPoint> points = {};  // of rising time
  bool by_clock = false;                // times are seconds since 1970 (UTC); else seconds since the first frame of the video
  double position_step_deg = 0.0;       // positions are rounded to this; 0: finer than matters
};

// The state at a time: positions, heights and angles between two points are interpolated, settings of the camera are those of the nearer point.
// Nothing is known beyond `most_apart_s` from the next point, and between points that are further apart than twice that.
std::optional<TrackPoint> StateAt(const FlightTrack& track, double time_s, double most_apart_s = 2.0);

// Ten points per second say all of a flight. Drones write up to 60, which would fill the memory in hours.
constexpr double kLeastApart_s = 0.09;
// Sorts by time and leaves out points that are nearer to the one before.
void TidyPoints(std::vector<TrackPoint>& points);

// Keeps a position only when it is on Earth and not 0, 0, which drones write before they know it.
void SetPosition(double latitude_deg, double longitude_deg, TrackPoint& point);

// A date and a time such as 2024-03-20 12:59:17.852, 2017.08.05 14:11:51,393,525 or 2024-03-20T12:59:17+02:00 that begin somewhere in the text:
// seconds since 1970, as written, less the stated offset from UTC. Nothing when there is none.
std::optional<double> FindClock(std::string_view text);

// The number at the beginning of the text, behind spaces and a sign; nothing when there is none or it is not finite. `length`: of what was read.
std::optional<double> LeadingNumber(std::string_view text, size_t* length = nullptr);

}  // namespace skyquilt::prepare::video
