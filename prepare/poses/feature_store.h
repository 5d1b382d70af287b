// Descriptors of photos from COLMAP's database, packed for the matching kernel and kept in memory as far as allowed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/kernel/descriptors.h"
#include "core/survey/colmap_database.h"

namespace skyquilt::prepare::poses {

// For packed descriptors; about a thousand photos.
constexpr size_t kFeatureMemory_bytes = size_t{1} << 30U;

class FeatureStore {
 public:
  // names: of the photos, which the database must have; their numbers below are places in it. max_bytes: of packed descriptors that are kept; those
  // in use count too, but are never dropped. Throws base::InputError for a damaged database and for a photo that is not in it.
  FeatureStore(const std::filesystem::path& database, const std::vector<std::string>& names, size_t max_bytes);

  // Any number of threads at a time.
  std::shared_ptr<const kernel::PackedDescriptors> Packed(uint32_t photo);
  // Rows of 128 bytes, features with the largest radius first.
  std::vector<uint8_t> LargestFirst(uint32_t photo);

  uint32_t ImageId(uint32_t photo) const { return image_ids_[photo]; }
  survey::ColmapDatabase& database() { return database_; }
  const std::filesystem::path& file() const { return file_; }  // of the database
  size_t n_loads() const { return n_loads_; }

 private:
  struct Kept {
    uint32_t photo;
    size_t bytes;
    std::shared_ptr<const kernel::PackedDescriptors> packed;
  };
  std::filesystem::path file_;
  std::mutex mutex_;  // guards all below but image_ids_
  survey::ColmapDatabase database_;
  std::vector<uint32_t> image_ids_;
  size_t max_bytes_, kept_bytes_ = 0, n_loads_ = 0;
  std::list<Kept> kept_;  // the last used first
  std::unordered_map<uint32_t, std::list<Kept>::iterator> place_;
};

}  // namespace skyquilt::prepare::poses
