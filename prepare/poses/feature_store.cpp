#include "prepare/poses/feature_store.h"

#include <algorithm>
#include <numeric>

#include "core/base/errors.h"

namespace skyquilt::prepare::poses {

FeatureStore::FeatureStore(const std::filesystem::path& database, const std::vector<std::string>& names, size_t max_bytes)
    : file_(std::filesystem::absolute(database)), database_(database), max_bytes_(max_bytes) {
  std::unordered_map<std::string, uint32_t> id_of_name;
  for (const survey::DatabaseImage& image : database_.ReadImages()) id_of_name.emplace(image.name, image.id);
  image_ids_.reserve(names.size());
  for (const std::string& name : names) {
    const auto found = id_of_name.find(name);
    if (found == id_of_name.end()) {
      throw base::InputError(database, "has no photo " + name,
                             "Remove the folder " + database.parent_path().string() + ", then run the same command again");
    }
    image_ids_.push_back(found->second);
  }
}

std::shared_ptr<const kernel::PackedDescriptors> FeatureStore::Packed(uint32_t photo) {
  const std::lock_guard lock(mutex_);
  if (const auto found = place_.find(photo); found != place_.end()) {
    kept_.splice(kept_.begin(), kept_, found->second);
    return kept_.front().packed;
  }
  auto packed = std::make_shared<const kernel::PackedDescriptors>(kernel::PackDescriptors(database_.ReadDescriptors(image_ids_[photo])));
  ++n_loads_;
  const size_t bytes = packed->lines.size() * sizeof(packed->lines[0]) + packed->offset.size() * sizeof(packed->offset[0]);
  kept_.push_front({photo, bytes, packed});
  place_[photo] = kept_.begin();
  kept_bytes_ += bytes;
  while (kept_bytes_ > max_bytes_ && kept_.size() > 1) {
    kept_bytes_ -= kept_.back().bytes;
    place_.erase(kept_.back().photo);
    kept_.pop_back();
  }
  return packed;
}

std::vector<uint8_t> FeatureStore::LargestFirst(uint32_t photo) {
  const std::lock_guard lock(mutex_);
  const std::vector<survey::DatabaseKeypoint> keypoints = database_.ReadKeypoints(image_ids_[photo]);
  const std::vector<uint8_t> descriptors = database_.ReadDescriptors(image_ids_[photo]);
  constexpr size_t kRowBytes = survey::kDatabaseDescriptorBytes;
  if (keypoints.size() * kRowBytes != descriptors.size()) return descriptors;
  std::vector<size_t> order(keypoints.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return keypoints[a].scale > keypoints[b].scale; });
  std::vector<uint8_t> sorted(descriptors.size());
  for (size_t i = 0; i < order.size(); ++i) {
    std::copy_n(descriptors.begin() + static_cast<std::ptrdiff_t>(order[i] * kRowBytes), kRowBytes,
                sorted.begin() + static_cast<std::ptrdiff_t>(i * kRowBytes));
  }
  return sorted;
}

}  // namespace skyquilt::prepare::poses
