// Subtitles that drones write beside their videos, in all their forms.
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "prepare/video/subtitles.h"
#include "tests/fuzz/fuzz_target.h"

namespace skyquilt::fuzz {

std::vector<std::string> Seeds() {
  return {
      "1\n00:00:00,000 --> 00:00:00,033\n<font size=\"28\">FrameCnt: 1, DiffTime: 33ms\n2024-03-20 12:59:17.852\n[iso: 400] [shutter: 1/320.0] "
      "[fnum: "
      "1.7] [ev: 2.0] [focal_len: 24.00] [latitude: 30.123000] [longitude: -81.456000] [rel_alt: 6.500 abs_alt: -32.309] [gb_yaw: 33.5 gb_pitch: "
      "-60.0 "
      "gb_roll: 0.0] </font>\n\n2\n00:00:00,133 --> 00:00:00,166\n[latitude: 30.124000] [longitude: -81.457000] [rel_alt: 6.600] </font>\n\n",
      "1\r\n00:00:01,000 --> 00:00:02,000\r\nHOME(149.0251,-20.2532) 2017.08.05 14:11:51\r\nGPS(149.0251,-20.2533,16) BAROMETER:1.9\r\nISO:100 "
      "Shutter:60 "
      "EV: Fnum:F2.2\r\n\r\n",
      "36\n00:00:35,000 --> 00:00:36,000\nF/6.3, SS 60, ISO 100, EV 0, RTK (120.083799, 30.213635, 28), HOME (120.084146, 30.214243, 103.55m), D "
      "75.36m, "
      "H 76.19m, H.S 0.30m/s, F.PRY (-5.3\xC2\xB0, 2.1\xC2\xB0, 28.3\xC2\xB0), G.PRY (-40.0\xC2\xB0, 0.0\xC2\xB0, 28.2\xC2\xB0)\n",
      "1\n2017.08.05 14:11:51,393,525\n[latitude : 31.45] [longtitude : 74.40] [altitude: 213.98] [fnum : 280] [focal_len : 240]\n\n2\n2017.08.05 "
      "14:11:52,393,525\n[latitude : 31.46] [longtitude : 74.40]\n",
      "1\n00:00:00,000 --> 00:00:01,000\nHOME(E: 120.0, N: 20.0) 2024-01-02 12:00:01\nGPS(E: 120.000001, N: 20.000001, 001.01m) ISO:100 SHUTTER:30 "
      "F-NUM:2.8\n"};
}

void Feed(const std::string& bytes) {
  try {
    std::istringstream in(bytes);
    const prepare::video::FlightTrack track = prepare::video::ParseSubtitles(in, "a.SRT");
    // What the header promises.
    for (size_t i = 0; i < track.points.size(); ++i) {
      const prepare::video::TrackPoint& point = track.points[i];
      const bool rises = i == 0 || point.time_s > track.points[i - 1].time_s;
      const bool on_earth = !point.latitude_deg || (std::abs(*point.latitude_deg) <= 90.0 && std::abs(*point.longitude_deg) <= 180.0);
      const bool exposed = !point.exposure_time_s || (*point.exposure_time_s > 0.0 && std::isfinite(*point.exposure_time_s));
      if (!std::isfinite(point.time_s) || !rises || !on_earth || !exposed) std::abort();
    }
    prepare::video::StateAt(track, 0.5);
  } catch (const base::InputError&) {
  }
}

}  // namespace skyquilt::fuzz
