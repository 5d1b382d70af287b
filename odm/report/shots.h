// Cameras and photos as OpenSfM and OpenDroneMap describe them: cameras.json, shots.geojson, images.json.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/survey/exif.h"
#include "core/survey/survey.h"
#include "surface/map_frame.h"

namespace skyquilt::odm {

// The frame of the maps, from the survey alone. vertical: products.vertical. Throws base::InputError when heights have to be converted and PROJ has
// no geoid.
surface::MapFrame FrameOf(const survey::Survey& survey, geo::Vertical vertical);

// Key of a camera in cameras.json, which shots name: "v2 <make and model> <width> <height> <projection> <focal>".
std::string CameraKey(const survey::Survey& survey, int camera);
// One member per camera that a photo has. OpenSfM's units: focal lengths and offsets from the middle as shares of the longer side. Lenses: "brown",
// "perspective", "fisheye_opencv"; those of other models have their COLMAP name and parameters instead.
nlohmann::ordered_json CamerasJson(const survey::Survey& survey);

// A point per photo in longitude, latitude and the maps' height, with rotation (axis times angle, from the axes of the maps to the camera),
// translation (the camera's place in map coordinates), focal, width, height, camera and capture_time (seconds since 1970 by the camera's clock; 0:
// unknown). tags: of the photos, in their order. The survey must be geo-referenced.
nlohmann::ordered_json ShotsJson(const survey::Survey& survey, const surface::MapFrame& frame, const std::vector<survey::PhotoTags>& tags);

// A row per photo, those without a pose too: filename, size, place, time, camera. Unknown values are null.
nlohmann::ordered_json ImagesJson(const survey::Survey& survey, const std::vector<survey::PhotoTags>& tags);

// Ground control points in longitude and latitude: id (CHK- before those that are only compared), error (east, north, up in metres, null: unknown),
// and observations: shot_id, annotated and reprojected as shares of the photo's width and height. Points without a usable mark have no observations.
nlohmann::ordered_json ControlPointsJson(const survey::Survey& survey, const surface::MapFrame& frame);

}  // namespace skyquilt::odm
