// Poses of a survey's photos from their tags and verified matches, in place of COLMAP's mapper, whose time per photo grows with the survey. Positions
// come from GPS, directions from the gimbal or, for cameras that look straight down, from the matches. Then all features that several photos share
// become points, and bundle adjustments move everything to where the matches want it; the tags keep hardly any weight. Time grows about linearly with
// the number of photos. Wrong tags must not garble a survey: tags are compared with the matches first, and the result is judged by the matches alone.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/base/thread_pool.h"
#include "core/survey/colmap_model.h"
#include "prepare/poses/seed/seed_input.h"

namespace skyquilt::prepare::poses {

struct SeededModel {
  survey::ColmapModel model;                // ENU metres about the median of the tags, as good as the tags; points are black
  survey::ColmapObservations observations;  // of its points; pixels of the stored photos
  double median_error = 0.0;                // reprojection, pixels of a photo of 1600 pixels width
  double median_gps_m = 0.0;                // horizontal distance between cameras and tags
  bool by_gimbal = false;                   // directions from gimbal angles, not from matches
  std::string summary;                      // for the log
};

// Empty when the tags cannot be used or the result cannot be trusted: `reason` then says why, in words for the user, and the mapper must do it.
// Photos whose matches contradict the others are left out of the model. The same input gives the same bits, whatever the number of threads. Throws
// base::Interrupted when asked to stop; std::logic_error for photos or pairs with unknown ids.
std::optional<SeededModel> SeedPoses(const SeedInput& input, base::ThreadPool& threads, std::string* reason);

// The model in COLMAP's binary format, with its observations.
void WriteSeededModel(const SeededModel& seeded, const std::filesystem::path& folder);

}  // namespace skyquilt::prepare::poses
