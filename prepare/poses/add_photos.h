// Poses of photos that are added to a finished survey, whose own poses and lenses stay as they are. The added photos and those around them get a
// model of their own, as any survey; it is laid on the survey by the photos that both have, or by tags where it has none in common with it; then the
// added photos are adjusted to all matches, while those of the survey are held.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/camera/camera.h"
#include "core/geo/geodetic.h"
#include "core/geo/transform.h"
#include "core/survey/colmap_model.h"
#include "prepare/input/photo_files.h"
#include "prepare/poses/colmap_step.h"
#include "prepare/poses/pose_options.h"
#include "prepare/poses/pose_task.h"

namespace skyquilt::prepare::poses {

struct KnownPose {
  geo::Rigid3d cam_from_enu;
  camera::Camera camera;
};

struct KnownPoses {
  geo::Geodetic origin;        // of the ENU frame
  bool georeferenced = false;  // false: tags can place nothing in the frame
  std::map<std::string, KnownPose> photos;
};

struct AddedPoses {
  survey::ColmapModel model;              // in ENU metres: the added photos, and those around them with the poses that are known
  std::vector<std::string> by_tags = {};  // added photos that only their tags place
};

// The added photos, those of the survey that may show the same ground by their tags, and those around these; in the order of `photos`. All, where
// photos that are added have no place. `known`: per photo, whether it is one of the survey.
std::vector<size_t> PhotosAround(const std::vector<input::PhotoFile>& photos, const std::vector<bool>& known);

// photos: as PhotosAround chose them. Cameras of added photos are new ones, with ids that no known photo has. Added photos that cannot be placed are
// not in the model; a warning says how many. Throws base::InputError when none can be, and as RunColmap does; base::Interrupted.
AddedPoses FindAddedPoses(const ColmapJob& job, const std::vector<input::PhotoFile>& photos, const KnownPoses& known, const PoseOptions& options,
                          base::ThreadPool& threads, RemoteTasks* ranks);

// The similarity that lays poses on others of the same photos: the rotation that most of them agree with, then scale and place by medians, so that
// photos on one line and a few wrong poses are enough. Photo i has the poses a[i] and b[i]; at least 2. The scale is 1 where all are at one place.
geo::Similarity3d SimilarityOfPoses(const std::vector<geo::Rigid3d>& cam_from_a, const std::vector<geo::Rigid3d>& cam_from_b);

}  // namespace skyquilt::prepare::poses
