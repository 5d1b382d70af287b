// Joins the context and the blocks' checkpoints into one scene file: inference parameters only, no optimiser state.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/geo/geodetic.h"
#include "core/scene/scene.h"

namespace skyquilt::merge {

struct TrainedBlock {
  std::filesystem::path checkpoint;
  double gsd_m = 0.0;  // ground sampling distance of its photos
};

struct MergeInput {
  std::filesystem::path context;
  std::vector<TrainedBlock> blocks;  // empty or failed blocks left out
  geo::Geodetic origin;
  bool georeferenced = false;
  scene::Borders borders = scene::Borders::kSmooth;
  checkpoint::Precision storage = checkpoint::Precision::kFloat32;  // of the hash tables
  bool use_context = true;                                          // false: the context does not fill what no block covers (independent blocks)
  std::string config_toml;                                          // stored in the scene
  std::string config_hash;
  std::filesystem::path scene;  // out
};

// Throws base::InputError: a checkpoint missing, damaged, unfinished, or of another survey origin; disk full.
void MergeScene(const MergeInput& input);

}  // namespace skyquilt::merge
