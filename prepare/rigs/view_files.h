// Files of views: pictures with tags and masks, each complete or missing.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "prepare/rigs/panorama_picture.h"
#include "prepare/rigs/panorama_views.h"

namespace skyquilt::prepare::rigs {

// A panorama with the views that it shall give.
struct PanoramaJob {
  input::PhotoFile photo;
  SphereArea area;
  camera::Camera camera;           // of its views
  std::vector<std::string> names;  // of its views, one for each of the layout
};

struct ViewFolders {
  std::filesystem::path panoramas;  // names of panoramas are relative to it
  std::filesystem::path pictures, masks;
};

// Views of which more than this share is masked are left out.
constexpr double kMostMasked = 0.95;

// Writes those views that are not there yet, their masks first. `masked`: the share of each view that its mask ignores, by name, also of those left
// out. Throws base::InputError when the panorama cannot be read or a file not be written, base::Interrupted.
void WriteViews(const PanoramaJob& job, const std::vector<PanoramaView>& views, double nadir_deg, const ViewFolders& folders,
                std::map<std::string, double>* masked, base::ThreadPool& threads);

}  // namespace skyquilt::prepare::rigs
