// Exports a project's tour as a folder that plays in a browser, from any web server and from file://, without this program. Its files:
//   index.html, tour.js, tour.css, licences.txt   the page
//   poster.jpg, embed.html                        a picture for links; how to show the tour in another page
//   tour.mp4                                      with a video
//   data/                                         scripts with the data, see script_data.h
// docs/files.md lists the data.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "tour/export/export_parts.h"
#include "tour/export/tour_options.h"
#include "tour/format/tour.h"
#include "tour/pictures/render_picture.h"

namespace skyquilt::tour {

struct ExportInput {
  std::filesystem::path project;    // folder with tour.json, tour/assets, measurements.geojson
  std::filesystem::path work;       // folder for rendered pictures, from which an interrupted export continues
  std::filesystem::path out;        // is created, or is an earlier export; may be project/tour
  std::string exposure = "normal";  // of stops that state none, as products.exposure
  TourOptions options;
  // Writes a video of the tour to this file; null: none. Its bytes count.
  std::function<void(const Tour& tour, const std::filesystem::path& file)> make_video;
};

struct Exported {
  int64_t bytes = 0;  // of all files
  size_t stops = 0;
  size_t tiles = 0, tiles_of = 0;    // in it; of the surface
  std::vector<std::string> missing;  // plain sentences: what the tour names and is not there
};

// The folder is complete afterwards, or as it was before, or (only when this is killed while it moves the files to their place) without index.html.
// Throws base::InputError (no tour, damaged files, disk full, not enough room for the least that the tour needs, a folder with something else in it),
// base::UsageError for an exposure that is not allowed, base::Interrupted.
Exported ExportTour(const ExportInput& input, const ExportParts& parts, const PictureField& field, base::ThreadPool& threads);

}  // namespace skyquilt::tour
