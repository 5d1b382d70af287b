#include "worker/train_options.h"

#include "core/base/errors.h"

namespace skyquilt::worker {

std::vector<config::Field<TrainOptions>> TrainOptions::Fields() {
  using config::Range;
  using O = TrainOptions;
  return {
      {"steps", &O::steps, Range::AtLeast(0), "optimiser steps per field; 0: as many as the time budget allows"},
      {"seconds", &O::seconds, Range{0, 1e8}, "time budget of one field in seconds when steps = 0; 0: its part of the run's budget"},
      {"batch_samples", &O::batch_samples, Range{256, 4194304}, "samples per step; the number of rays adapts to it"},
      {"encoding", &O::encoding, Range::OneOf({"hash", "voxels", "planes", "frequency"}),
       "of positions: hash (a grid of many resolutions), or for comparison voxels (one dense grid), planes (planes times lines) or frequency (sines "
       "and cosines); voxels and planes get about as many parameters as hash would have"},
      {"levels", &O::levels, Range{1, 16}, "resolutions of the hash grid"},
      {"features", &O::features, Range::OneOf({2, 4}), "numbers per grid entry; levels * features must be a multiple of 4"},
      {"base_resolution", &O::base_resolution, Range{1, 4096}, "cells along the longest edge at the coarsest level"},
      {"hidden", &O::hidden, Range{4, 256}.MultipleOf(4), "width of the hidden layers"},
      {"density_hidden_layers", &O::density_hidden_layers, Range{1, 8}, "hidden layers of the density network"},
      {"color_hidden_layers", &O::color_hidden_layers, Range{1, 3}, "hidden layers of the colour network"},
      {"sh_degree", &O::sh_degree, Range{1, 4}, "degree of the spherical harmonics of the viewing direction; 1: colour does not depend on it"},
      {"learning_rate", &O::learning_rate, Range{1e-6, 1}, "learning rate of Adam at the start"},
      {"final_learning_rate_share", &O::final_learning_rate_share, Range{1e-6, 1}, "learning rate at the end as a share of the first"},
      {"step_voxels", &O::step_voxels, Range{0.25, 16}, "distance between the samples of a ray as a multiple of the finest voxel"},
      {"stratified", &O::stratified, Range(),
       "true: the first sample of a ray lies anywhere in its step, another place every time; false: in the middle"},
      {"network_l2", &O::network_l2, Range{0, 1}, "weight decay of the networks"},
      {"distortion", &O::distortion, Range{0, 100}, "weight of the distortion loss that draws a ray's matter together; 0 turns it off"},
      {"empty_ray_share", &O::empty_ray_share, Range{0, 0.5}, "share of rays that end outside the block and teach emptiness only"},
      {"checkpoint_every_s", &O::checkpoint_every_s, Range{1e-3, 1e8}, "seconds between checkpoints"},
      {"coupling", &O::coupling, Range::OneOf({"guided", "independent"}),
       "guided: the context stands in for what lies outside the block; independent: blocks alone"},
      {"start", &O::start, Range::OneOf({"surfaces", "everywhere"}),
       "where a field first looks for matter: surfaces (between the sparse points, blocks where the context sees surfaces) or everywhere (for "
       "comparison)"},
  };
}

void TrainOptions::Check(const std::string& section) const {
  config::CheckRanges(section, *this);
  if (levels * features % 4 != 0) {
    throw base::UsageError(section + ".levels = " + std::to_string(levels) + " is not allowed with " + section +
                           ".features = " + std::to_string(features) + ": levels * features must be a multiple of 4");
  }
}

}  // namespace skyquilt::worker
