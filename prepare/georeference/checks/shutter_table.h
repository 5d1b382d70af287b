// Read-out times of drone cameras' sensors. A rolling shutter exposes the rows of a photo one after the other, so that a moving camera sees the first
// and the last row from different places.
#pragma once

#include <optional>
#include <string>

namespace skyquilt::prepare::georeference {

struct ShutterQuery {
  std::string camera_name;           // make and model as tagged, e.g. "DJI FC300S"
  int width = 0;                     // of the photos, pixels; some cameras read less of the sensor for wide pictures
  int height = 0;                    // pixels
  std::optional<double> exposure_s;  // some cameras use their mechanical shutter only for long exposures; nothing: taken as long
};

// Milliseconds from the first to the last row; 0 for a mechanical or global shutter, NaN for cameras that are not in the table. Case and spaces in
// the name do not matter.
double SensorReadout(const ShutterQuery& query);

// "DJI FC300S"; without the make when the model already begins with it ("Canon PowerShot ELPH 300 HS").
std::string CameraName(const std::string& make, const std::string& model);

}  // namespace skyquilt::prepare::georeference
