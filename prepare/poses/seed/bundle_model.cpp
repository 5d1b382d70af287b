#include "prepare/poses/seed/bundle_model.h"

#include <unordered_map>
#include <vector>

#include "prepare/bundle/feature_tracks.h"

namespace skyquilt::prepare::poses {
namespace {

// Observations of each photo that agree with points that at least three photos see.
std::vector<size_t> CountFirmObservations(const bundle::BundleProblem& bundle, const std::vector<uint32_t>& n_agreeing) {
  std::vector<size_t> n(bundle.photos.size(), 0);
  for (uint32_t t = 0; t < bundle.tracks.size(); ++t) {
    if (n_agreeing[t] < 3) continue;
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) n[bundle.tracks.entries[e].photo] += bundle.agrees[e] != 0 ? 1 : 0;
  }
  return n;
}

// Points of the model. An error along the line that joins two photos shows in none of them, so points that only two photos see are left out (COLMAP's
// default too), except where a photo has few others.
std::vector<uint32_t> TracksOfModel(const bundle::BundleProblem& bundle) {
  constexpr size_t kEnough = 200;
  std::vector<uint32_t> n_agreeing(bundle.tracks.size(), 0), tracks;
  for (uint32_t t = 0; t < bundle.tracks.size(); ++t) {
    if (bundle.has_point[t] == 0) continue;
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) n_agreeing[t] += bundle.agrees[e] != 0 ? 1 : 0;
  }
  const std::vector<size_t> n_firm = CountFirmObservations(bundle, n_agreeing);
  for (uint32_t t = 0; t < bundle.tracks.size(); ++t) {
    if (bundle.has_point[t] == 0) continue;
    bool wanted = n_agreeing[t] >= 3;
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) {
      wanted = wanted || (bundle.agrees[e] != 0 && n_firm[bundle.tracks.entries[e].photo] < kEnough);
    }
    if (wanted) tracks.push_back(t);
  }
  return tracks;
}

}  // namespace

void FillTracks(const SeedInput& input, bundle::BundleProblem& bundle) {
  std::unordered_map<uint32_t, uint32_t> index;
  std::vector<size_t> n_features;
  for (uint32_t i = 0; i < input.photos.size(); ++i) {
    index.emplace(input.photos[i].image_id, i);
    n_features.push_back(input.photos[i].features.size());
  }
  std::vector<bundle::IndexedPair> pairs;
  for (const PairMatches& matches : input.pairs) pairs.push_back({index.at(matches.image_a), index.at(matches.image_b), matches.features});
  bundle.tracks = bundle::JoinMatches(pairs, n_features);
  for (const bundle::TrackEntry& entry : bundle.tracks.entries)
    bundle.pixel.push_back(input.photos[entry.photo].features[entry.feature].cast<double>());
  bundle.point.assign(bundle.tracks.size(), Eigen::Vector3d::Zero());
  bundle.has_point.assign(bundle.tracks.size(), 0);
  bundle.agrees.assign(bundle.tracks.entries.size(), 0);
}

void ModelOfBundle(const SeedInput& input, const bundle::BundleProblem& bundle, survey::ColmapModel* model,
                   survey::ColmapObservations* observations) {
  size_t i = 0;
  for (const auto& [id, lens] : input.cameras) {
    model->cameras.emplace(id, bundle::CameraOf(bundle.lenses[i].numbers, lens.camera));
    ++i;
  }
  for (i = 0; i < bundle.photos.size(); ++i) {
    const bundle::BundlePhoto& photo = bundle.photos[i];
    if (!photo.placed) continue;
    survey::ColmapImage image{input.photos[i].image_id, input.photos[i].camera_id, input.photos[i].name, {}};
    image.cam_from_world = {photo.cam_from_enu, -(photo.cam_from_enu * photo.centre)};
    model->images.push_back(std::move(image));
    (*observations)[input.photos[i].image_id];
  }
  for (const uint32_t t : TracksOfModel(bundle)) {
    survey::ColmapPoint point;
    point.id = model->points.size() + 1;
    point.x_in_world = bundle.point[t];
    double sum = 0.0;
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) {
      if (bundle.agrees[e] == 0) continue;
      const uint32_t photo = bundle.tracks.entries[e].photo;
      const uint32_t image_id = input.photos[photo].image_id;
      point.image_ids.push_back(image_id);
      sum += bundle.Error(e, point.x_in_world) * bundle.lenses[static_cast<size_t>(bundle.photos[photo].lens)].unit_px;
      (*observations)[image_id].push_back({point.id, bundle.pixel[e]});
    }
    point.error_px = sum / static_cast<double>(point.image_ids.size());
    model->points.push_back(std::move(point));
  }
}

}  // namespace skyquilt::prepare::poses
