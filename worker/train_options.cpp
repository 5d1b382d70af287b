#include "worker/train_options.h"

#include <cmath>
#include <stdexcept>

#include "core/base/errors.h"
#include "core/encoding/encoding.h"

namespace skyquilt::worker {

void TrainOptions::Visit(config::OptionVisitor& v) {
  v.Field("steps", steps, "optimiser steps per field; 0: as many as the time budget allows");
  v.Field("seconds", seconds, "time budget of one field in seconds when steps = 0; 0: the run's budget is shared out");
  v.Field("batch_samples", batch_samples, "samples per step; the number of rays adapts to it");
  v.Field(
      "encoding", encoding,
      "of positions: hash (a grid of many resolutions), or for comparison voxels (one dense grid), planes (planes times lines) or frequency (sines "
      "and cosines); voxels and planes get about as many parameters as hash would have");
  v.Field("levels", levels, "resolutions of the hash grid, 1..16");
  v.Field("features", features, "numbers per grid entry, 2 or 4; levels * features must be a multiple of 4");
  v.Field("base_resolution", base_resolution, "cells along the longest edge at the coarsest level");
  v.Field("hidden", hidden, "width of the hidden layers, a multiple of 4 up to 256");
  v.Field("density_hidden_layers", density_hidden_layers, "hidden layers of the density network, 1..8");
  v.Field("color_hidden_layers", color_hidden_layers, "hidden layers of the colour network, 1..3");
  v.Field("sh_degree", sh_degree, "spherical harmonics of the viewing direction: degree 1 (none) to 4");
  v.Field("learning_rate", learning_rate, "of Adam at the start");
  v.Field("final_learning_rate_share", final_learning_rate_share, "learning rate at the end as a share of the first");
  v.Field("step_voxels", step_voxels, "distance between the samples of a ray as a multiple of the finest voxel, 0.25..16");
  v.Field("stratified", stratified, "the first sample of a ray anywhere in its step (a new place every time), not always in the middle");
  v.Field("network_l2", network_l2, "weight decay of the networks");
  v.Field("distortion", distortion, "weight of the distortion loss that draws a ray's matter together; 0 turns it off");
  v.Field("empty_ray_share", empty_ray_share, "share of rays that end outside the block and teach emptiness only, 0..0.5");
  v.Field("checkpoint_every_s", checkpoint_every_s, "seconds between checkpoints");
  v.Field("coupling", coupling, "guided: the context stands in for what lies outside the block; independent: blocks alone");
  v.Field("start", start,
          "where a field first looks for matter: surfaces (between the sparse points, blocks where the context sees surfaces) or everywhere (for "
          "comparison)");
}

void TrainOptions::Check(const std::string& section) const {
  const auto require = [&](bool ok, const std::string& key, const std::string& rule, double value) {
    if (!ok) throw base::UsageError(section + "." + key + " must be " + rule + ", got " + std::to_string(value));
  };
  require(steps >= 0, "steps", "0 or more", steps);
  require(std::isfinite(seconds) && seconds >= 0.0, "seconds", "0 or more", seconds);
  require(batch_samples >= 256 && batch_samples <= (1 << 22), "batch_samples", "256..4194304", batch_samples);
  try {
    encoding::KindNamed(encoding);
  } catch (const std::invalid_argument& error) {
    throw base::UsageError(section + "." + error.what());
  }
  require(levels >= 1 && levels <= 16, "levels", "1..16", levels);
  require(features == 2 || features == 4, "features", "2 or 4", features);
  require(levels * features % 4 == 0, "levels", "such that levels * features is a multiple of 4", levels);
  require(base_resolution >= 1 && base_resolution <= 4096, "base_resolution", "1..4096", base_resolution);
  require(hidden >= 4 && hidden <= 256 && hidden % 4 == 0, "hidden", "a multiple of 4 in 4..256", hidden);
  require(density_hidden_layers >= 1 && density_hidden_layers <= 8, "density_hidden_layers", "1..8", density_hidden_layers);
  require(color_hidden_layers >= 1 && color_hidden_layers <= 3, "color_hidden_layers", "1..3", color_hidden_layers);
  require(sh_degree >= 1 && sh_degree <= 4, "sh_degree", "1..4", sh_degree);
  require(learning_rate > 0.0 && learning_rate < 1.0, "learning_rate", "in (0, 1)", learning_rate);
  require(final_learning_rate_share > 0.0 && final_learning_rate_share <= 1.0, "final_learning_rate_share", "in (0, 1]", final_learning_rate_share);
  require(step_voxels >= 0.25 && step_voxels <= 16.0, "step_voxels", "0.25..16", step_voxels);
  require(network_l2 >= 0.0 && network_l2 < 1.0, "network_l2", "in [0, 1)", network_l2);
  require(distortion >= 0.0 && distortion < 100.0, "distortion", "0..100", distortion);
  require(empty_ray_share >= 0.0 && empty_ray_share <= 0.5, "empty_ray_share", "0..0.5", empty_ray_share);
  require(checkpoint_every_s > 0.0, "checkpoint_every_s", "positive", checkpoint_every_s);
  if (coupling != "guided" && coupling != "independent") {
    throw base::UsageError(section + ".coupling must be \"guided\" or \"independent\", got \"" + coupling + "\"");
  }
  if (start != "surfaces" && start != "everywhere") {
    throw base::UsageError(section + ".start must be \"surfaces\" or \"everywhere\", got \"" + start + "\"");
  }
}

}  // namespace skyquilt::worker
