#include "prepare/survey_points.h"

#include <algorithm>
#include <set>
#include <vector>

#include "core/base/log.h"
#include "core/base/random.h"
#include "core/survey/training_points.h"
#include "prepare/georeference/filter_sparse_points.h"

namespace skyquilt::prepare {
namespace {

// Ascending indices into Survey::photos, each once.
std::vector<int32_t> TrackOf(const survey::ColmapPoint& point, const std::unordered_map<uint32_t, int32_t>& photo_of_image) {
  std::set<int32_t> photos;
  for (const uint32_t id : point.image_ids) {
    if (const auto found = photo_of_image.find(id); found != photo_of_image.end()) photos.insert(found->second);
  }
  return {photos.begin(), photos.end()};
}

}  // namespace

bool IsKeptPoint(uint64_t colmap_id, int every) {
  return every > 0 && base::MixBits(colmap_id) % static_cast<uint64_t>(every) == 0;
}

void FillPoints(const survey::ColmapModel& model, const geo::Similarity3d& enu_from_model,
                const std::unordered_map<uint32_t, int32_t>& photo_of_image, int keep_every, survey::Survey& survey) {
  const bool any_track = std::any_of(model.points.begin(), model.points.end(),
                                     [&](const survey::ColmapPoint& point) { return !TrackOf(point, photo_of_image).empty(); });
  std::vector<survey::SparsePoint> points;
  std::vector<size_t> of_model;  // where the points are in the model
  for (size_t i = 0; i < model.points.size(); ++i) {
    const survey::ColmapPoint& point = model.points[i];
    const size_t n_training = survey::CountTrainingPhotos(survey, TrackOf(point, photo_of_image));
    if (any_track && n_training < survey::kFewestTrainingObservers) continue;
    points.push_back({enu_from_model * point.x_in_world, point.rgb, static_cast<float>(point.error_px), static_cast<int>(n_training)});
    of_model.push_back(i);
  }
  if (of_model.size() < model.points.size()) {
    base::LogInfo("{} of {} sparse points are not used, because fewer than two training photos observed them", model.points.size() - of_model.size(),
                  model.points.size());
  }
  const std::vector<size_t> good = georeference::FilterSparsePoints(points);
  for (size_t i = 0; i < good.size(); ++i) {
    const survey::ColmapPoint& point = model.points[of_model[good[i]]];
    const bool kept = IsKeptPoint(point.id, keep_every);
    (kept ? survey.kept_points : survey.points).push_back(points[i]);
    if (any_track) (kept ? survey.kept_tracks : survey.tracks).Add(TrackOf(point, photo_of_image));
  }
  survey::KeepTrainingObservations(survey);
  if (keep_every > 0) base::LogInfo("{} sparse points are kept from training, to measure depth errors with", survey.kept_points.size());
}

}  // namespace skyquilt::prepare
