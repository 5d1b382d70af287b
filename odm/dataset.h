// The folder of a dataset: what NodeODM, or a person, has put there.
//   images/                        photos, and masks called PHOTO_mask.*
//   gcp_list.txt, geo.txt          control points, positions of the photos (unless --gcp and --geo name others)
//   image_groups.txt               parts of split and merge, which are not needed here
//   skyquilt/                      our project folder
#pragma once

#include <filesystem>
#include <string>

#include "core/base/thread_pool.h"
#include "odm/request.h"

namespace skyquilt::odm {

struct Dataset {
  std::filesystem::path folder;   // absolute
  std::filesystem::path images;   //
  std::filesystem::path project;  //
  std::string gcp;                // absolute path; empty: no control points, or --use-exif
  std::string geo;                // absolute path of --geo; empty: as 'skyquilt prepare' finds it
  bool has_groups = false;        // image_groups.txt is there
  int photos = 0;
  double megapixels = 0.0;  // of a photo, mean; 0: not known
};

// Throws base::InputError: no such folder, no photos, or a file that was named and is not there.
Dataset FindDataset(const Request& request, base::ThreadPool& threads);

// Writes what --boundary says, a path or GeoJSON, to boundary.geojson in the project folder and returns its path; empty without --boundary. The
// project folder must be there. Throws base::InputError for what is neither, and where there is no polygon.
std::string ProvideBoundary(const Request& request, const Dataset& dataset);

// JSON whose quotes were lost: NodeODM takes all double quotes out of an option's value. Names and texts get theirs back; what is valid JSON stays as
// it is. What cannot be understood is returned unchanged.
std::string RestoreQuotes(const std::string& text);

}  // namespace skyquilt::odm
