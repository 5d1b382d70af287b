#include "prepare/bundle/camera_sample.h"

#include <algorithm>
#include <set>
#include <unordered_map>

#include "core/base/disjoint_sets.h"

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

size_t CountPhotos(const SamplePoint& point) {
  std::set<int> photos;
  for (const Sighting& sighting : point.sightings) photos.insert(sighting.photo);
  return photos.size();
}

void DropWeakPoints(std::vector<SamplePoint>& points) {
  std::erase_if(points, [](const SamplePoint& point) { return CountPhotos(point) < kMinPhotosOfPoint; });
}

// All points of the model that enough of the photos see.
std::vector<SamplePoint> CollectPoints(const survey::ColmapModel& model, const survey::ColmapObservations& observations,
                                       const std::vector<const survey::ColmapImage*>& photos) {
  std::unordered_map<uint64_t, size_t> index;
  std::vector<SamplePoint> points(model.points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    index.emplace(model.points[i].id, i);
    points[i].x_in_world = model.points[i].x_in_world;
  }
  for (size_t photo = 0; photo < photos.size(); ++photo) {
    const auto list = observations.find(photos[photo]->id);
    if (list == observations.end()) continue;
    for (const survey::ColmapObservation& observation : list->second) {
      const auto found = index.find(observation.point_id);
      if (found != index.end()) points[found->second].sightings.push_back({static_cast<int>(photo), observation.pixel});
    }
  }
  DropWeakPoints(points);
  return points;
}

std::vector<SamplePoint> EvenlyChosen(std::vector<SamplePoint> points, size_t max_points) {
  if (points.size() <= max_points) return points;
  std::vector<SamplePoint> chosen;
  chosen.reserve(max_points);
  for (size_t i = 0; i < max_points; ++i) chosen.push_back(std::move(points[i * points.size() / max_points]));
  return chosen;
}

// Per photo: true for those of the largest group that points connect.
std::vector<char> LargestGroup(size_t n_photos, const std::vector<SamplePoint>& points) {
  base::DisjointSets groups(n_photos);
  for (const SamplePoint& point : points) {
    for (const Sighting& sighting : point.sightings) {
      groups.Join(static_cast<uint32_t>(sighting.photo), static_cast<uint32_t>(point.sightings.front().photo));
    }
  }
  std::vector<int> size(n_photos, 0);
  for (uint32_t photo = 0; photo < n_photos; ++photo) ++size[groups.Root(photo)];
  std::vector<char> keep(n_photos, 0);
  if (n_photos == 0) return keep;
  const auto largest = static_cast<uint32_t>(std::max_element(size.begin(), size.end()) - size.begin());
  for (uint32_t photo = 0; photo < n_photos; ++photo) keep[photo] = groups.Root(photo) == largest ? 1 : 0;
  return keep;
}

// Leaves out all photos that are not to be kept, and points that too few of the others see.
void Keep(const std::vector<char>& keep, std::vector<const survey::ColmapImage*>& photos, std::vector<SamplePoint>& points) {
  std::vector<int> new_index(photos.size(), -1);
  size_t n_kept = 0;
  for (size_t photo = 0; photo < photos.size(); ++photo) {
    if (keep[photo] == 0) continue;
    new_index[photo] = static_cast<int>(n_kept);
    photos[n_kept++] = photos[photo];
  }
  photos.resize(n_kept);
  for (SamplePoint& point : points) {
    std::erase_if(point.sightings, [&](const Sighting& sighting) { return keep[static_cast<size_t>(sighting.photo)] == 0; });
    for (Sighting& sighting : point.sightings) sighting.photo = new_index[static_cast<size_t>(sighting.photo)];
  }
  DropWeakPoints(points);
}

std::vector<char> WellSeen(size_t n_photos, const std::vector<SamplePoint>& points) {
  std::vector<int> n_sightings(n_photos, 0);
  for (const SamplePoint& point : points) {
    for (const Sighting& sighting : point.sightings) ++n_sightings[static_cast<size_t>(sighting.photo)];
  }
  std::vector<char> keep(n_photos, 0);
  for (size_t photo = 0; photo < n_photos; ++photo) keep[photo] = n_sightings[photo] >= kMinSightings ? 1 : 0;
  return keep;
}

}  // namespace

CameraSample SelectSample(const survey::ColmapModel& model, const survey::ColmapObservations& observations, uint32_t camera_id, size_t max_photos,
                          size_t max_points) {
  std::vector<const survey::ColmapImage*> photos = ConsecutivePhotos(model, camera_id, max_photos);
  CameraSample sample;
  sample.points = CollectPoints(model, observations, photos);
  const size_t n_all = sample.points.size();
  sample.points = EvenlyChosen(std::move(sample.points), max_points);
  if (n_all > 0) sample.share_of_points = static_cast<double>(sample.points.size()) / static_cast<double>(n_all);
  Keep(LargestGroup(photos.size(), sample.points), photos, sample.points);
  // Leaving out a photo takes sightings from others' points. Each round but the last removes a photo, so this ends.
  for (std::vector<char> keep = WellSeen(photos.size(), sample.points); std::find(keep.begin(), keep.end(), 0) != keep.end();
       keep = WellSeen(photos.size(), sample.points)) {
    Keep(keep, photos, sample.points);
    Keep(LargestGroup(photos.size(), sample.points), photos, sample.points);
  }
  sample.cam_from_world.reserve(photos.size());
  for (const survey::ColmapImage* photo : photos) sample.cam_from_world.push_back(photo->cam_from_world);
  return sample;
}

}  // namespace skyquilt::prepare::bundle
