#include "prepare/survey_points.h"

#include <set>
#include <utility>
#include <vector>

#include "core/base/log.h"
#include "core/base/mix_bits.h"
#include "prepare/sparse_cloud.h"

namespace skyquilt::prepare {
namespace {

std::vector<survey::SparsePoint> ConvertPoints(const survey::ColmapModel& model, const geo::Similarity3d& enu_from_model) {
  std::vector<survey::SparsePoint> points;
  points.reserve(model.points.size());
  for (const survey::ColmapPoint& point : model.points) {
    // A point may be seen more than once in one photo; only the number of photos counts.
    const std::set<uint32_t> photos(point.image_ids.begin(), point.image_ids.end());
    points.push_back({enu_from_model * point.x_in_world, point.rgb, static_cast<float>(point.error_px), static_cast<int>(photos.size())});
  }
  return points;
}

std::vector<int32_t> TrackOf(const survey::ColmapPoint& point, const std::unordered_map<uint32_t, int32_t>& photo_of_image) {
  std::vector<int32_t> photos;
  photos.reserve(point.image_ids.size());
  for (const uint32_t id : point.image_ids) {
    if (const auto found = photo_of_image.find(id); found != photo_of_image.end()) photos.push_back(found->second);
  }
  return photos;
}

}  // namespace

bool IsKeptPoint(uint64_t colmap_id, int every) {
  return every > 0 && base::MixBits(colmap_id) % static_cast<uint64_t>(every) == 0;
}

void FillPoints(const survey::ColmapModel& model, const geo::Similarity3d& enu_from_model,
                const std::unordered_map<uint32_t, int32_t>& photo_of_image, int keep_every, survey::Survey& survey) {
  std::vector<survey::SparsePoint> points = ConvertPoints(model, enu_from_model);
  const std::vector<size_t> good = FilterSparsePoints(points);
  for (size_t i = 0; i < good.size(); ++i) {
    const survey::ColmapPoint& of_model = model.points[good[i]];
    const bool kept = IsKeptPoint(of_model.id, keep_every);
    (kept ? survey.kept_points : survey.points).push_back(points[i]);
    (kept ? survey.kept_tracks : survey.tracks).Add(TrackOf(of_model, photo_of_image));
  }
  // Formats without tracks: none is known, rather than points that nobody saw.
  if (survey.tracks.observations() + survey.kept_tracks.observations() == 0) survey.tracks = survey.kept_tracks = {};
  if (keep_every > 0) base::LogInfo("{} sparse points are kept from training, to measure depth errors with", survey.kept_points.size());
}

}  // namespace skyquilt::prepare
