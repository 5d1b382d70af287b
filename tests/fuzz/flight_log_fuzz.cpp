// Flight logs beside a video: GPX and CSV.
#include <cmath>
#include <cstdlib>

#include "prepare/video/csv_track.h"
#include "prepare/video/gpx.h"
#include "tests/fuzz/fuzz_target.h"

namespace skyquilt::fuzz {
namespace {

void CheckTrack(const prepare::video::FlightTrack& track) {
  for (size_t i = 0; i < track.points.size(); ++i) {
    const prepare::video::TrackPoint& point = track.points[i];
    const bool rises = i == 0 || point.time_s > track.points[i - 1].time_s;
    const bool on_earth = !point.latitude_deg || (std::abs(*point.latitude_deg) <= 90.0 && std::abs(*point.longitude_deg) <= 180.0);
    if (!std::isfinite(point.time_s) || !rises || !on_earth) std::abort();
  }
}

}  // namespace

std::vector<std::string> Seeds() {
  return {
      "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" xmlns=\"http://www.topografix.com/GPX/1/1\"><trk><trkseg><trkpt lat=\"47.25\" "
      "lon=\"8.5\"><ele>512.5"
      "</ele><time>2024-03-20T12:00:02+01:00</time></trkpt><trkpt lat=\"47.24\" "
      "lon=\"8.5\"><time>2024-03-20T11:00:00.500Z</time></trkpt></trkseg></trk>"
      "</gpx>",
      "time(millisecond),datetime(utc),latitude,longitude,height_above_takeoff(feet),gimbal_pitch(degrees),isVideo\n0,2024-03-20 "
      "11:00:00,47.5,8.5,100,-90,0\n100,2024-03-20 11:00:00,47.6,8.5,200,,1\n400,2024-03-20 11:00:01,47.7,8.5,NaN,-45,1\n",
      "\xEF\xBB\xBFt;lat;lon;alt\n0,5;47,1;8,5;3\n1,5;47,2;8,5;4\n"};
}

void Feed(const std::string& bytes) {
  FeedFile("a.gpx", bytes, [](const std::filesystem::path& file) { CheckTrack(prepare::video::ReadGpx(file)); });
  FeedFile("a.csv", bytes, [](const std::filesystem::path& file) {
    for (const prepare::video::FlightTrack& track : prepare::video::ReadCsvTracks(file)) CheckTrack(track);
  });
}

}  // namespace skyquilt::fuzz
