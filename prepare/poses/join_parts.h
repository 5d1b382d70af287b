// Parts of a survey that have no features in common, as zones taken on different days: the mapper makes a model of each, and the tags of their photos
// place them beside each other.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geo/geodetic.h"
#include "core/geo/transform.h"
#include "core/survey/colmap_model.h"
#include "prepare/input/photo_files.h"

namespace skyquilt::prepare::poses {

struct Part {
  survey::ColmapModel model;
  survey::ColmapObservations observations;
};

// Where tags place a model.
struct TaggedPlace {
  geo::Similarity3d enu_from_model;  // metres
  double median_m = 0.0;             // horizontal distance of its photos to their tags
};

// By gimbal angles and positions where the angles agree with the poses, else by positions alone. Tags that are far off have no part in it. Nothing
// where tags do not hold a model: fewer than kLeastOfPart (seed/verdict.h) of its photos have them, more than 30 % contradict the others, or they
// are on a line without angles. A height without a tag is that above take-off. `about`: origin of the ENU frame; nothing: the first photo with a tag.
std::optional<TaggedPlace> PlaceByTags(const survey::ColmapModel& model, const std::vector<input::PhotoFile>& photos,
                                       const std::optional<geo::Geodetic>& about = {});

// Moves poses and points.
void Transform(const geo::Similarity3d& map, survey::ColmapModel& model);

// The largest part and all others that tags place, as one model in metres, with a camera of its own for each part. `only_apart`: only parts that show
// other ground; those that show the same should have features in common, and the tags' errors would be seen in it. Photos that are in several parts
// are of the largest. Logs what is joined. Nothing when nothing can be. `parts`: the largest first.
std::optional<Part> JoinParts(const std::vector<Part>& parts, const std::vector<input::PhotoFile>& photos, bool only_apart);

// Names of the photos that are tied together by at least kLeastTied (loose_photos.h) common points of two photos each, of each such part with
// kLeastOfPart photos or more, the largest part first.
std::vector<std::vector<std::string>> PartsOf(const survey::ColmapModel& model);

}  // namespace skyquilt::prepare::poses
