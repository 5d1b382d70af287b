// Reads a flight log in CSV: a heading, and a row per moment. Columns are found by their names, of which these are known, in any case and with a unit
// in brackets behind them (feet, ft, milliseconds, ms, mph):
//   time                time, time_s, seconds, t, timestamp, time(millisecond): since the beginning of the video, or of the flight with `isvideo`;
//                       datetime, datetime(utc), date: UTC
//   latitude, lat; longitude, lon, lng
//   height              height_above_takeoff, relative_altitude, rel_alt, height, agl;  altitude_above_sealevel, abs_alt, altitude, alt, ele,
//   elevation gimbal              gimbal_heading, gimbal_yaw, gb_yaw, yaw; gimbal_pitch, gb_pitch, pitch; gimbal_roll, gb_roll, roll isvideo 1 while
//   the drone filmed (AirData): the time then begins anew with each recording
#pragma once

#include <filesystem>
#include <vector>

#include "prepare/video/track.h"

namespace skyquilt::prepare::video {

// One track, or with `isvideo` one per recording. None: the table has no columns of time and position, as it is about something else. Throws
// base::InputError for a file that is no table, and for numbers that are none, with the line.
std::vector<FlightTrack> ReadCsvTracks(const std::filesystem::path& file);

}  // namespace skyquilt::prepare::video
