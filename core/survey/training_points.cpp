#include "core/survey/training_points.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

namespace skyquilt::survey {
namespace {

std::vector<int32_t> TrainingPhotosOf(const std::vector<Photo>& photos, std::span<const int32_t> observers) {
  std::vector<int32_t> training;
  std::copy_if(observers.begin(), observers.end(), std::back_inserter(training), [&](int32_t i) { return !photos[static_cast<size_t>(i)].is_test; });
  return training;
}

size_t RemoveUnseen(const std::vector<Photo>& photos, bool keep_held_out, std::vector<SparsePoint>& points, PointTracks& tracks) {
  PointTracks remaining;
  size_t n = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    const std::span<const int32_t> observers = tracks.PhotosOf(i);
    std::vector<int32_t> training = TrainingPhotosOf(photos, observers);
    if (training.size() < kFewestTrainingObservers) continue;
    points[n] = points[i];
    points[n++].track_length = static_cast<int>(training.size());
    remaining.Add(keep_held_out ? std::vector<int32_t>(observers.begin(), observers.end()) : std::move(training));
  }
  const size_t removed = points.size() - n;
  points.resize(n);
  tracks = std::move(remaining);
  return removed;
}

}  // namespace

size_t CountTrainingPhotos(const Survey& survey, std::span<const int32_t> photos) {
  return static_cast<size_t>(std::count_if(photos.begin(), photos.end(), [&](int32_t i) { return !survey.photos[static_cast<size_t>(i)].is_test; }));
}

size_t KeepTrainingObservations(Survey& survey) {
  if (!survey.HasTracks()) return 0;
  return RemoveUnseen(survey.photos, false, survey.points, survey.tracks) + RemoveUnseen(survey.photos, true, survey.kept_points, survey.kept_tracks);
}

}  // namespace skyquilt::survey
