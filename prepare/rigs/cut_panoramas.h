// Panoramas are cut into pinhole views with known places on a rig, so that all that follows works as with photos.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::rigs {

struct PanoramaOptions {
  std::string which = "auto";                            // auto: photos that say so; all: and those twice as wide as high; none
  int per_ring = 4;                                      // views around
  std::vector<double> pitches_deg = {0.0, -35.0, 35.0};  // of the rings, up from the horizon
  double fov_deg = 90.0;                                 // of the views
  int width = 0;                                         // of the views in pixels; 0: as sharp as the panorama (WidthAsSharp)
  double nadir_mask_deg = 0.0;                           // half the angle of the cone straight down that is masked; 0: none
};

// Which photos are panoramas: those whose GPano tags say ProjectionType = equirectangular, and with `which` = all those that are twice as wide as
// high. The log tells of those that only might be.
std::vector<size_t> FindPanoramas(const std::vector<input::PhotoFile>& photos, const std::string& which);

// Where the photos are now.
struct CutPhotos {
  std::filesystem::path picture_root;  // all photos, under their names
  std::filesystem::path masks;         // their masks; empty: none has one
};

// Replaces the panoramas (indices of photos.usable) by their views and writes to `folder`:
//   views/pano_view00/NAME.jpg   views as JPEG with the panorama's time, place and exposure and their own gimbal angles; links to all other photos
//   views/rig_config.json        the rig of the views (rig_config.h)
//   view_masks/                  masks of views and links to those of other photos, when there are any
//   views.csv                    a row for each view: of which panorama, whether it is taken and if not why, its direction and tags; written last
//   views.json                   what they were made of, so that a second call goes on where the first was interrupted
// Every file is complete or missing. Panoramas that cannot be read are left out, with a warning, and listed in photos.unreadable. `now`: where the
// photos are before, and after where they are now; nothing changes without panoramas, but what an earlier call made is removed. Throws
// base::InputError when fewer than three photos remain or a file cannot be written, base::Interrupted.
void CutPanoramas(const std::vector<size_t>& panoramas, const PanoramaOptions& options, const std::filesystem::path& folder, CutPhotos& now,
                  input::PhotoSet& photos, base::ThreadPool& threads);

}  // namespace skyquilt::prepare::rigs
