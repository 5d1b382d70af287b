// Poses, lenses and points that owe nothing to held-out photos (prepare.holdout_poses = "resected"): these photos are taken out of the model, what
// remains is adjusted to its own observations, and once everything else is final they are placed by its points, with points and lenses held (space
// resection; Kraus, Photogrammetry, 2007, chapter 4). What the search for poses decided before stays: which features are one point, and which photos
// have a pose.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <unordered_set>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/colmap_model.h"
#include "prepare/georeference/georeference.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare {

struct WithheldPhotos {
  std::vector<survey::ColmapImage> images;  // as the model had them
  survey::ColmapObservations observations;  // of all photos
  double tie_sigma = 1.0;                   // of features, per axis, in pixels of a photo of 1600 pixels width
};

// Takes the photos with these ids out of the model and adjusts the others, their lenses and their points to the observations of these others alone.
// The frame stays about where it was. Points that fewer than two of them observed go, as do those that the adjustment cannot place: they would be
// where the withheld photos had put them. Nothing, with the model as it was and a reason for the user, when there is no such adjustment: few
// observations, a lens that it does not know, photos that only the withheld ones tie to the rest, or a focal length that drifts away without them.
// Throws base::Interrupted. The same input gives the same bits, whatever the number of threads.
std::optional<WithheldPhotos> WithholdPhotos(const std::unordered_set<uint32_t>& withheld, survey::ColmapObservations observations,
                                             survey::ColmapModel& model, base::ThreadPool& threads, std::string* reason);

// Puts the withheld photos back at the end of the model's images, in any frame that the model has been moved to, and into the tracks of the points
// that they show within a few sigmas of where these are. Nothing else in the model changes. Photos with fewer than kLeastObservations
// (bundle/resect.h) such points stay out; returns their names.
std::vector<std::string> ResectWithheld(const WithheldPhotos& photos, survey::ColmapModel& model);

// Adds photos that had no part in a geo-reference to its list, which afterwards is in the order of `photos`. `resected`: names that include
// theirs and of the others none. Their tags count as not agreeing; each is compared with its photo as that of the photo nearest to it in time was.
void AddResected(const std::vector<input::PreparedPhoto>& photos, const std::set<std::string>& resected, georeference::Georeference& georeference);

}  // namespace skyquilt::prepare
