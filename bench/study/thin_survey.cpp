#include "bench/study/thin_survey.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/log.h"
#include "core/base/thread_pool.h"
#include "core/survey/training_points.h"
#include "prepare/georeference/filter_sparse_points.h"

namespace skyquilt::bench {

double TiltDeg(const survey::Photo& photo) {
  const Eigen::Vector3d axis = photo.cam_from_enu.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  return std::atan2(axis.head<2>().norm(), -axis.z()) * 180.0 / std::numbers::pi;
}

void KeepPhotos(survey::Survey& survey, const std::vector<bool>& keep) {
  std::vector<survey::Photo> kept;
  std::vector<int32_t> new_index;
  new_index.reserve(keep.size());
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    new_index.push_back(keep[i] ? static_cast<int32_t>(kept.size()) : -1);
    if (keep[i]) kept.push_back(std::move(survey.photos[i]));
  }
  survey.photos = std::move(kept);
  if (!survey.HasTracks()) {
    base::LogWarning("nothing tells which photos saw which sparse points, so those of all photos are used");
    return;
  }
  survey.tracks = survey.tracks.Renumbered(new_index);
  survey.kept_tracks = survey.kept_tracks.Renumbered(new_index);
  const size_t removed = survey::KeepTrainingObservations(survey);
  base::LogInfo("{} of {} photos stay; without the others {} sparse points are unknown and {} remain", survey.photos.size(), keep.size(), removed,
                survey.points.size() + survey.kept_points.size());
  base::ThreadPool threads;
  prepare::georeference::MeasureAgl(survey, threads);
}

survey::Survey ThinSurvey(survey::Survey survey, const Variant& variant) {
  const auto chosen = [&variant](const survey::Photo& photo) {
    if (TiltDeg(photo) > variant.max_tilt_deg) return false;
    return variant.photo_prefixes.empty() || std::any_of(variant.photo_prefixes.begin(), variant.photo_prefixes.end(),
                                                         [&photo](const std::string& prefix) { return photo.name.starts_with(prefix); });
  };
  std::vector<bool> keep;
  keep.reserve(survey.photos.size());
  int number = 0;
  for (const survey::Photo& photo : survey.photos) {
    keep.push_back(photo.is_test || (chosen(photo) && number++ % variant.every_nth_photo == 0));
  }
  KeepPhotos(survey, keep);
  return survey;
}

}  // namespace skyquilt::bench
