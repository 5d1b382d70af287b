// A small survey on disk: photos that look straight down on level ground at z = 10 m from 60 m above it, with sparse points on it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "core/survey/survey.h"
#include "tests/support/nadir_photo.h"

namespace skyquilt::masks {

constexpr int kPhotoWidth = 120, kPhotoHeight = 90;
constexpr double kGround_m = 10.0;

// Cameras at x = 0, 20, 40 ... m, y = 0; a pixel is 0.5 m on the ground. Photos are grey with a red square of 10 pixels at (20, 30).
inline survey::Survey MakeMaskSurvey(const std::filesystem::path& folder, int n_photos, bool georeferenced) {
  survey::Survey survey;
  survey.origin = {47.5, 8.6, 400.0};
  survey.georeferenced = georeferenced;
  survey.photo_root = folder / "images";
  survey.cameras.push_back({camera::CameraModel::kPinhole, kPhotoWidth, kPhotoHeight, {120.0, 120.0, 60.0, 45.0}});
  std::filesystem::create_directories(survey.photo_root / "sub");
  for (int i = 0; i < n_photos; ++i) {
    survey.photos.push_back(NadirPhoto({20.0 * i, 0.0, kGround_m + 60.0}, "sub/" + std::to_string(i) + ".png"));
    image::Image8 photo(kPhotoWidth, kPhotoHeight, 3, static_cast<uint8_t>(100 + i));
    for (int y = 30; y < 40; ++y) {
      for (int x = 20; x < 30; ++x) {
        photo.At(x, y)[0] = 240;
        photo.At(x, y)[1] = photo.At(x, y)[2] = 20;
      }
    }
    image::SavePng(photo, survey.photo_root / survey.photos.back().name);
  }
  for (double x = -30.0; x <= 30.0 + 20.0 * n_photos; x += 3.0) {
    for (double y = -24.0; y <= 24.0; y += 3.0) {
      survey::SparsePoint point;
      point.x_in_enu = {x, y, kGround_m};
      point.track_length = 3;
      survey.points.push_back(point);
    }
  }
  return survey;
}

}  // namespace skyquilt::masks
