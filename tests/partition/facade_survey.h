// Level photos of a wall for partition tests, and which photos observed which points of a survey.
#pragma once

#include "core/base/random.h"
#include "core/camera/photo_visibility.h"
#include "partition/partition_options.h"
#include "tests/partition/flown_survey.h"

namespace skyquilt::partition {

// Every training photo observes every point in its frame; points know how many did.
inline void ObserveAll(survey::Survey* survey) {
  survey->tracks = {};
  for (survey::SparsePoint& point : survey->points) {
    std::vector<int32_t> photos;
    for (size_t i = 0; i < survey->photos.size(); ++i) {
      const survey::Photo& photo = survey->photos[i];
      if (photo.is_test) continue;
      if (camera::IsVisible(survey->cameras[static_cast<size_t>(photo.camera)], photo.cam_from_enu, point.x_in_enu)) {
        photos.push_back(static_cast<int32_t>(i));
      }
    }
    point.track_length = static_cast<int>(photos.size());
    survey->tracks.Add(std::move(photos));
  }
}

constexpr double kFromWall_m = 12.0;

constexpr double kFacadeFocal_px = 500.0;

// A wall of 48 x 6 m, the ground before it and some things behind it, in 12 photos of 800 x 600 pixels at eye level, of which two are held out.
inline survey::Survey FacadeSurvey() {
  FlownSurveyOptions nothing;
  nothing.photos_per_side = nothing.n_points = 0;
  survey::Survey survey = FlySurvey(nothing);
  survey.cameras[0].params = {kFacadeFocal_px, kFacadeFocal_px, 400.0, 300.0};
  for (int i = 0; i < 12; ++i) {
    survey.photos.push_back(LevelPhoto({2.0 + 4.0 * i, 0.0, 1.6}, "photo_" + std::to_string(i) + ".jpg"));
    survey.photos.back().agl_m = 1.6;
    survey.photos.back().is_test = i % 8 == 0;
  }
  base::Random random(3);
  for (int i = 0; i < 3600; ++i) {
    survey::SparsePoint point;
    point.x_in_enu = {random.Uniform(0.0, 48.0), kFromWall_m + random.Uniform(-0.4, 0.4), random.Uniform(0.0, 6.0)};
    if (i % 6 == 0) point.x_in_enu = {point.x_in_enu.x(), random.Uniform(5.0, kFromWall_m), 0.0};
    if (i % 12 == 1) point.x_in_enu = {point.x_in_enu.x(), random.Uniform(kFromWall_m, 36.0), random.Uniform(0.0, 10.0)};
    survey.points.push_back(point);
  }
  ObserveAll(&survey);
  return survey;
}

// So many blocks, with tables that fit the content.
inline PartitionOptions Request(const std::string& blocks) {
  PartitionOptions options;
  options.blocks = blocks;
  options.max_log2_table_size = 19;  // large enough that sizes differ
  options.voxels_per_entry = options.max_voxels_per_entry = 1.0;
  return options;
}

}  // namespace skyquilt::partition
