// The part of the preparation that lets GPS tags straighten a bent reconstruction.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/survey/colmap_model.h"
#include "prepare/georeference/georeference.h"
#include "prepare/georeference/place_options.h"
#include "prepare/input/prepared_photo.h"

namespace skyquilt::prepare::georeference {

struct ShapeInput {
  const PlaceOptions& options;
  std::filesystem::path model_folder;               // where the model's observations are read from; they are features of photos
  std::map<uint32_t, double> tagged_focal_px = {};  // by the camera ids of the model, where tags say it
};

// Whether tags can say more of the shape than the photos do: most of them are RTK fixes, or the heights differ from theirs like a dome or a bowl (by
// more than 3 sigma and kLeastBend_m).
bool TagsTellTheShape(const std::vector<input::PreparedPhoto>& photos, const Georeference& georeference);
constexpr double kLeastBend_m = 0.5;

// When they can, adjusts the model to the tags and places it on Earth again: model, photos and geo-reference are the new ones then, and
// georeference.fit.adjusted_to_tags is set. Photos that look straight down hardly tell the focal length: when the adjustment takes it, or the height
// above ground, from where the tags say it is to far from there, it is made once more with the focal lengths of the model. Otherwise, and when the
// photos contradict the tags, nothing changes. The log says which. Needs a place on Earth. Throws base::Interrupted.
void ShapeByTags(const ShapeInput& input, survey::ColmapModel& model, std::vector<input::PreparedPhoto>& photos, Georeference& georeference,
                 base::ThreadPool& threads);

}  // namespace skyquilt::prepare::georeference
