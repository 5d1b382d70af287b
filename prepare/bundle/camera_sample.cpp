#include "prepare/bundle/camera_sample.h"

#include <algorithm>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/base/disjoint_sets.h"
#include "prepare/bundle/entry_term.h"

namespace skyquilt::prepare::bundle {
namespace {

constexpr size_t kMinPhotosOfPoint = 3;

std::vector<const survey::ColmapImage*> ConsecutivePhotos(const survey::ColmapModel& model, uint32_t camera_id, size_t max_photos) {
  std::vector<const survey::ColmapImage*> photos;
  for (const survey::ColmapImage& image : model.images) {
    if (image.camera_id == camera_id) photos.push_back(&image);
  }
  std::sort(photos.begin(), photos.end(), [](const auto* a, const auto* b) { return a->name < b->name; });
  if (photos.size() <= max_photos) return photos;
  const auto first = photos.begin() + static_cast<std::ptrdiff_t>((photos.size() - max_photos) / 2);
  return {first, first + static_cast<std::ptrdiff_t>(max_photos)};
}

// Calls `use` with the track and the photo of each sighting of the sample.
template <typename Use>
void ForEachSighting(const BundleProblem& bundle, const Use& use) {
  for (uint32_t t = 0; t < bundle.tracks.size(); ++t) {
    if (bundle.has_point[t] == 0) continue;
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) {
      if (Counts(bundle, e)) use(t, bundle.tracks.entries[e].photo);
    }
  }
}

void DropWeakPoints(BundleProblem& bundle) {
  std::vector<size_t> n_photos(bundle.tracks.size(), 0);
  std::vector<uint32_t> last(bundle.tracks.size(), UINT32_MAX);
  ForEachSighting(bundle, [&](uint32_t track, uint32_t photo) { n_photos[track] += std::exchange(last[track], photo) != photo ? 1 : 0; });
  for (size_t t = 0; t < n_photos.size(); ++t) bundle.has_point[t] = n_photos[t] >= kMinPhotosOfPoint ? 1 : 0;
}

// All points of the model that enough of the photos see.
BundleProblem CollectPoints(const survey::ColmapModel& model, const survey::ColmapObservations& observations,
                            const std::vector<const survey::ColmapImage*>& photos) {
  std::unordered_map<uint64_t, size_t> index;
  for (size_t i = 0; i < model.points.size(); ++i) index.emplace(model.points[i].id, i);
  std::vector<std::vector<std::pair<TrackEntry, Eigen::Vector2d>>> sightings(model.points.size());
  BundleProblem bundle;
  for (uint32_t photo = 0; photo < photos.size(); ++photo) {
    const geo::Rigid3d& pose = photos[photo]->cam_from_world;
    bundle.photos.push_back({.cam_from_enu = pose.rotation, .centre = pose.OriginInSource(), .placed = true});
    const auto list = observations.find(photos[photo]->id);
    if (list == observations.end()) continue;
    for (uint32_t feature = 0; feature < list->second.size(); ++feature) {
      const auto found = index.find(list->second[feature].point_id);
      if (found != index.end()) sightings[found->second].push_back({{photo, feature}, list->second[feature].pixel});
    }
  }
  for (size_t i = 0; i < sightings.size(); ++i) {
    for (const auto& [entry, pixel] : sightings[i]) {
      bundle.tracks.entries.push_back(entry);
      bundle.pixel.push_back(pixel);
    }
    bundle.tracks.first.push_back(static_cast<uint32_t>(bundle.tracks.entries.size()));
    bundle.point.push_back(model.points[i].x_in_world);
  }
  bundle.has_point.assign(bundle.point.size(), 1);
  bundle.agrees.assign(bundle.pixel.size(), 1);
  DropWeakPoints(bundle);
  return bundle;
}

// Returns the share of points that remain.
double ChooseEvenly(BundleProblem& bundle, size_t max_points) {
  std::vector<size_t> points;
  for (size_t t = 0; t < bundle.has_point.size(); ++t) {
    if (bundle.has_point[t] != 0) points.push_back(t);
  }
  if (points.size() <= max_points) return 1.0;
  bundle.has_point.assign(bundle.has_point.size(), 0);
  for (size_t i = 0; i < max_points; ++i) bundle.has_point[points[i * points.size() / max_points]] = 1;
  return static_cast<double>(max_points) / static_cast<double>(points.size());
}

// Leaves out the photos that are not of the largest group that points connect, and points that too few of the others see.
void KeepLargest(BundleProblem& bundle) {
  base::DisjointSets groups(bundle.photos.size());
  std::vector<uint32_t> first(bundle.tracks.size(), UINT32_MAX);
  ForEachSighting(bundle, [&](uint32_t track, uint32_t photo) {
    if (first[track] == UINT32_MAX) first[track] = photo;
    groups.Join(photo, first[track]);
  });
  std::vector<int> size(bundle.photos.size(), 0);
  for (uint32_t photo = 0; photo < size.size(); ++photo) size[groups.Root(photo)] += bundle.photos[photo].placed ? 1 : 0;
  const auto largest = static_cast<uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());
  for (uint32_t photo = 0; photo < size.size(); ++photo) {
    if (groups.Root(photo) != largest) bundle.photos[photo].placed = false;
  }
  DropWeakPoints(bundle);
}

// Leaves out photos with few sightings. False when there are none.
bool DropWeakPhotos(BundleProblem& bundle) {
  std::vector<int> n_sightings(bundle.photos.size(), 0);
  ForEachSighting(bundle, [&](uint32_t /*track*/, uint32_t photo) { ++n_sightings[photo]; });
  bool dropped = false;
  for (size_t photo = 0; photo < n_sightings.size(); ++photo) {
    if (!bundle.photos[photo].placed || n_sightings[photo] >= kMinSightings) continue;
    bundle.photos[photo].placed = false;
    dropped = true;
  }
  DropWeakPoints(bundle);
  return dropped;
}

}  // namespace

CameraSample SelectSample(const survey::ColmapModel& model, const survey::ColmapObservations& observations, uint32_t camera_id, size_t max_photos,
                          size_t max_points) {
  CameraSample sample;
  BundleProblem& bundle = sample.bundle;
  bundle = CollectPoints(model, observations, ConsecutivePhotos(model, camera_id, max_photos));
  const camera::Camera& camera = model.cameras.at(camera_id);
  const bool centred = camera.PrincipalPoint() == Eigen::Vector2d(0.5 * Eigen::Vector2d(camera.width, camera.height));
  bundle.lenses = {{.numbers = LensOf(camera).value_or(Lens{}), .camera = camera, .free_centre = !centred}};
  sample.share_of_points = ChooseEvenly(bundle, max_points);
  // Leaving out a photo takes sightings from others' points. Each round but the last removes a photo, so this ends.
  do {
    KeepLargest(bundle);
  } while (DropWeakPhotos(bundle));
  for (uint32_t t = 0; t < bundle.tracks.size(); ++t) {
    for (uint32_t e = bundle.tracks.first[t]; e < bundle.tracks.first[t + 1]; ++e) {
      const BundlePhoto& photo = bundle.photos[bundle.tracks.entries[e].photo];
      // Where the camera does not see a point, its distortion has no meaning.
      bundle.agrees[e] = camera.ImgFromCam(photo.cam_from_enu * (bundle.point[t] - photo.centre)) ? 1 : 0;
    }
  }
  return sample;
}

}  // namespace skyquilt::prepare::bundle
