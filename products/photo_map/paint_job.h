// Everything that another process needs to paint tiles of a map from the photos of a survey: a file, beside the survey and its photos.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>

#include "core/base/thread_pool.h"
#include "core/geo/enu_frame.h"
#include "core/survey/survey.h"
#include "products/photo_map/photo_map.h"

namespace skyquilt::products {

// origin: of the survey's ENU frame, as in the projection of `input`. Throws base::InputError when the file cannot be written.
void WritePaintJob(const PhotoMapInput& input, const geo::Geodetic& origin, const PhotoMap& map, const std::filesystem::path& file);

class PaintJob {
 public:
  // Reads the file. picture_bytes: as in PhotoMapInput. Throws base::InputError when the file is damaged, and when a photo is not there or has
  // another size than where the file was written: its tiles would have other colours.
  PaintJob(survey::Survey survey, const std::filesystem::path& file, size_t picture_bytes, base::ThreadPool& threads);
  ~PaintJob();
  PaintJob(const PaintJob&) = delete;
  PaintJob& operator=(const PaintJob&) = delete;

  // The same bytes as those of the PhotoMap that the job was written from.
  PhotoMap& map() { return *map_; }
  const gis::MapGrid& grid() const;

 private:
  struct Data;  // what the map refers to

  std::unique_ptr<Data> data_;
  std::unique_ptr<PhotoMap> map_;
};

}  // namespace skyquilt::products
