// Compares the focal lengths of a model with those that the photos' tags say. Over level ground that looks alike everywhere, photos taken straight
// down fit a focal length that is far too long or too short about as well as the right one: the model then has few errors, and a wrong shape.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/camera/camera.h"
#include "core/survey/colmap_database.h"
#include "core/survey/colmap_model.h"
#include "core/survey/exif.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::poses {

// A focal length is far from the tagged one when it is less than this many times, or more than this many times as long. Tags say the focal length for
// a film of 35 mm by the width or by the diagonal, which differ by 4 % for usual photos, and in whole millimetres.
constexpr double kShortestFocal = 0.8, kLongestFocal = 1.25;
// And so a model is wrong when more than this share of its photos have such a camera.
constexpr double kMaxFarFocal = 0.1;

struct FarFocal {
  double found_px = 0.0;   // of the camera with the most photos among those that are far off
  double tagged_px = 0.0;  // of the same camera
  size_t n_photos = 0;     // of all cameras that are far off

  std::string Text() const;  // both numbers, for the log
};

// COLMAP's focal length for photos whose tags have none is 1.2 times the longer side.
bool IsGuessedFocal(const camera::Camera& camera);

// Width of the film that FocalLengthIn35mmFilm is for.
constexpr double kFilmWidth_mm = 36.0;

// The focal length in pixels of a photo of this size by its tags: XMP CalibratedFocalLength, else EXIF FocalLengthIn35mmFilm; nothing without. 0 and
// what is no number count as none.
std::optional<double> TaggedFocalPx(const survey::PhotoTags& tags, int width, int height);

// The same as below for focal lengths in pixels by the camera ids of the model; cameras that are not there are not judged.
std::optional<FarFocal> FindFocalFarFrom(const std::map<uint32_t, double>& tagged_px, const survey::ColmapModel& model);

// Tags are usually right to so much.
constexpr double kUsualFocalError = 0.1;
// Whether a camera's focal length differs by more than that from these, in pixels by the camera ids of the model; others are not judged.
bool AnyFocalMoved(const std::map<uint32_t, double>& from_px, const survey::ColmapModel& model);

// COLMAP takes the focal length of a camera from the tags of one of its photos, whatever they say. Where that is no lens's (IsPlausibleFocal35), or
// COLMAP read a picture without tags (PhotoFile::converted), the database gets the focal length that the photos' other tags say, as COLMAP computes
// it, or COLMAP's guess. A warning names the tag.
void CorrectFocals(const std::vector<input::PhotoFile>& photos, survey::ColmapDatabase& database);

// Empty when the model can be right. `tagged`: by the camera ids of the model, as COLMAP's database has them before any adjustment; cameras without a
// tagged focal length are not judged.
std::optional<FarFocal> FindFarFocal(const survey::ColmapModel& model, const std::map<uint32_t, camera::Camera>& tagged);

}  // namespace skyquilt::prepare::poses
