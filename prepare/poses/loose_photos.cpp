#include "prepare/poses/loose_photos.h"

#include <algorithm>
#include <map>
#include <set>
#include <unordered_map>
#include <unordered_set>

#include "core/base/disjoint_sets.h"

namespace skyquilt::prepare::poses {
namespace {

// Numbers of common points of pairs of photos; the key is the smaller id times 2^32 plus the larger.
std::unordered_map<uint64_t, size_t> CommonPoints(const survey::ColmapModel& model) {
  // The next few in the track: all pairs of a long one would take long.
  constexpr size_t kReach = 8;
  std::unordered_map<uint64_t, size_t> common;
  for (const survey::ColmapPoint& point : model.points) {
    const std::set<uint32_t> unique(point.image_ids.begin(), point.image_ids.end());
    const std::vector<uint32_t> seen(unique.begin(), unique.end());
    for (size_t i = 0; i < seen.size(); ++i) {
      for (size_t j = i + 1; j < std::min(seen.size(), i + 1 + kReach); ++j) ++common[(uint64_t{seen[i]} << 32U) + seen[j]];
    }
  }
  return common;
}

}  // namespace

std::vector<std::vector<std::string>> TiedPhotos(const survey::ColmapModel& model) {
  std::unordered_map<uint32_t, uint32_t> index;
  for (const survey::ColmapImage& image : model.images) index.emplace(image.id, static_cast<uint32_t>(index.size()));
  base::DisjointSets sets(index.size());
  for (const auto& [pair, n] : CommonPoints(model)) {
    if (n >= kLeastTied) sets.Join(index.at(static_cast<uint32_t>(pair >> 32U)), index.at(static_cast<uint32_t>(pair)));
  }
  std::map<uint32_t, std::vector<std::string>> members;
  for (const survey::ColmapImage& image : model.images) members[sets.Root(index.at(image.id))].push_back(image.name);
  std::vector<std::vector<std::string>> groups;
  for (auto& [root, names] : members) {
    std::sort(names.begin(), names.end());
    groups.push_back(std::move(names));
  }
  std::stable_sort(groups.begin(), groups.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return groups;
}

std::vector<std::string> LoosePhotos(const survey::ColmapModel& model) {
  if (model.points.empty()) return {};
  std::vector<std::string> loose;
  const std::vector<std::vector<std::string>> groups = TiedPhotos(model);
  for (size_t i = 1; i < groups.size(); ++i) loose.insert(loose.end(), groups[i].begin(), groups[i].end());
  std::sort(loose.begin(), loose.end());
  return loose;
}

void RemovePhotos(const std::function<bool(const survey::ColmapImage&)>& removed, survey::ColmapModel& model) {
  std::erase_if(model.images, removed);
  std::unordered_set<uint32_t> kept;
  for (const survey::ColmapImage& image : model.images) kept.insert(image.id);
  for (survey::ColmapPoint& point : model.points) std::erase_if(point.image_ids, [&](uint32_t id) { return !kept.contains(id); });
  std::erase_if(model.points, [](const survey::ColmapPoint& point) {
    return std::all_of(point.image_ids.begin(), point.image_ids.end(), [&](uint32_t id) { return id == point.image_ids.front(); });
  });
}

std::vector<std::string> RemoveLoosePhotos(survey::ColmapModel& model, survey::ColmapObservations& observations) {
  std::vector<std::string> loose = LoosePhotos(model);
  if (loose.empty()) return loose;
  RemovePhotos([&](const survey::ColmapImage& image) { return std::binary_search(loose.begin(), loose.end(), image.name); }, model);
  std::unordered_set<uint32_t> photos;
  for (const survey::ColmapImage& image : model.images) photos.insert(image.id);
  std::unordered_set<uint64_t> points;
  for (const survey::ColmapPoint& point : model.points) points.insert(point.id);
  std::erase_if(observations, [&](const auto& entry) { return !photos.contains(entry.first); });
  for (auto& [id, seen] : observations) std::erase_if(seen, [&](const survey::ColmapObservation& one) { return !points.contains(one.point_id); });
  return loose;
}

}  // namespace skyquilt::prepare::poses
