// Bends a reconstruction back to where its GPS tags say the cameras were. Pictures that look straight down hardly tell a wrong lens from a bent
// ground: the reconstruction then becomes a dome or a bowl, and no similarity straightens it. A bundle adjustment with the tags does (James and
// Robson, Mitigating systematic error in topographic models derived from UAV, 2014), as far as the tags are better than the bend.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/geo/geodetic.h"
#include "core/geo/transform.h"
#include "core/survey/colmap_model.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::control {

struct TagJob {
  survey::ColmapModel& model;  // in any frame; see AdjustToTags
  const survey::ColmapObservations& observations;
  const std::vector<input::PreparedPhoto>& photos;  // with the tags to use: corrected ones, without those that contradict
  geo::Geodetic origin;
  geo::Similarity3d enu_from_model;  // about where it belongs
  bool hold_focal = false;           // focal lengths stay those of the model
};

struct AdjustedToTags {
  bool adjusted = false;
  std::string reason;  // when not, for the user
  // Median error of the features in the model, pixels of a photo of 1600 pixels width.
  double error_before = 0.0, error_after = 0.0;
};

// When adjusted, poses, lenses and points of the model have been changed and are in ENU metres about `origin`; the frame of the whole is as good as
// the tags. Else the model is as it was: too few tags or features, a lens that the adjustment does not know, or tags that the photos contradict. Tags
// count with the accuracy that their scatter shows. Throws base::Interrupted. The same input gives the same bits, whatever the number of threads.
AdjustedToTags AdjustToTags(const TagJob& job, base::ThreadPool& threads);

}  // namespace skyquilt::prepare::control
