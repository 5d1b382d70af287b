// Reads what drones write into the subtitles of their videos: position, heights, gimbal and exposure, once per frame or once per second. DJI
// documents none of it. These forms are read, as public samples of 2016 to 2025 show them:
//   [latitude: 47.1] [longitude: 8.5] [rel_alt: 1.3 abs_alt: 121.0] [gb_yaw: 33.5 gb_pitch: -60.0 gb_roll: 0.0] [iso: 100] [shutter: 1/1000.0]
//   [fnum: 1.7] [focal_len: 24.00]      Mini 3 and later, Air 3, Mavic 3; with FrameCnt or SrtCnt before it, or neither
//   [latitude : 47.1] [longtitude : 8.5] [altitude: 213.9] [fnum : 280] [focal_len : 240]      Mavic 2, Air 2: hundredths and tenths
//   HOME(8.5,47.1) 2017.08.05 14:11:51 / GPS(8.5,47.1,16) BAROMETER:1.9 / ISO:100 Shutter:60 EV: Fnum:2.2      Mavic Pro, Phantom 4
//   F/2.8, SS 206.14, ISO 150, EV 0, GPS (8.5, 47.1, 10), D 2.80m, H 0.00m, H.S 0.00m/s, F.PRY (..), G.PRY (-40.0°, 0.0°, 28.2°)      Phantom 4 RTK,
//   Matrice 30; also RTK (...) for GPS (...)
//   GPS(47.1,8.5,0.0M) BAROMETER:0.3M      Matrice 300: latitude first, which the M tells
//   GPS(E: 8.5, N: 47.1, 001.01m)          Autel
// The third number of GPS(...) counts satellites, except where it has a unit. Times are those of the subtitles, or where these have none the clock.
#pragma once

#include <filesystem>
#include <istream>

#include "prepare/video/track.h"

namespace skyquilt::prepare::video {

// No points: the subtitles tell nothing of the flight. At most about ten points per second are kept. Throws base::InputError for a file that cannot
// be read or is no text in UTF-8 or Latin-1.
FlightTrack ReadSubtitles(const std::filesystem::path& file);
// The same of subtitles inside a video. `file`: for messages.
FlightTrack ParseSubtitles(std::istream& in, const std::filesystem::path& file);

}  // namespace skyquilt::prepare::video
