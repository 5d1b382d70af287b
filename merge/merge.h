// Joins the checkpoints of the context field and of all blocks into one scene file, which is all that rendering needs: the parameters of the
// fields, but no optimiser state.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/geo/geodetic.h"
#include "core/geo/height_reference.h"
#include "core/geo/place_accuracy.h"
#include "core/scene/scene.h"
#include "merge/look.h"

namespace skyquilt::merge {

struct TrainedBlock {
  std::filesystem::path checkpoint;  // of a block, trained to the end
  double gsd_m = 0.0;                // ground sampling distance of its photos, metres per pixel
  bool shows_context = false;        // the scene keeps its place, but shows the context there
};

struct MergeInput {
  std::filesystem::path context;     // checkpoint of the context field
  std::vector<TrainedBlock> blocks;  // in the order they get in the scene; without empty and failed ones
  geo::Geodetic origin;              // of the survey; every checkpoint must have the same
  bool georeferenced = false;
  // Of the survey.
  geo::PlaceAccuracy accuracy = {};
  geo::HeightReference height_reference = geo::HeightReference::kUnknown;
  scene::Borders borders = scene::Borders::kSmooth;                 // how neighbouring blocks are joined
  checkpoint::Precision storage = checkpoint::Precision::kFloat32;  // of the hash tables
  std::vector<LookPart> look;                                       // whose codes the scene shows; empty: the mean look
  bool use_context = true;  // false: leave the context field out, so that it does not fill places outside all blocks
  std::string config_toml;  // the whole configuration; stored in the scene
  std::string config_hash;
  std::filesystem::path scene;  // out
};

// Throws base::UsageError for a look that the checkpoints do not have, base::InputError when there is no block, or only blocks that show a context
// that is left out, when a checkpoint is missing, damaged, not trained to the end or of a survey with another origin, and when the scene cannot be
// written.
void MergeScene(const MergeInput& input);

}  // namespace skyquilt::merge
