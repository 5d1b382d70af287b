#include "worker/train_options.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/errors.h"
#include "worker/rays/photo_pyramid.h"

namespace skyquilt::worker {

std::vector<config::Field<TrainOptions>> TrainOptions::Fields() {
  using config::Range;
  using O = TrainOptions;
  return {
      {"steps", &O::steps, Range::AtLeast(0), "optimiser steps per field; 0: the time budget decides"},
      {"seconds", &O::seconds, Range{0, 1e8}, "training time of one field in seconds when steps = 0; 0: a part of the run's time budget"},
      {"batch_samples", &O::batch_samples, Range{256, 4194304}, "samples per optimiser step; the number of rays per step adapts to it"},
      {"encoding", &O::encoding, Range::OneOf({"hash", "voxels", "planes", "frequency"}),
       "encoding of positions: hash (multiresolution hash grid), or for comparison voxels (one dense grid), planes (planes times lines) or frequency "
       "(sines and cosines); voxels and planes get about as many parameters as hash"},
      {"levels", &O::levels, Range{1, 16}, "resolutions of the hash grid"},
      {"features", &O::features, Range::OneOf({2, 4}), "numbers per entry of the hash grid; levels * features must be a multiple of 4"},
      {"base_resolution", &O::base_resolution, Range{1, 4096}, "cells along the longest edge at the coarsest level of the hash grid"},
      {"hidden", &O::hidden, Range{4, 256}.MultipleOf(4), "width of the hidden layers of both networks"},
      {"density_hidden_layers", &O::density_hidden_layers, Range{1, 8}, "hidden layers of the density network"},
      {"density_activation", &O::density_activation, Range::OneOf({"exp", "softplus", "relu"}),
       "how the density network's output becomes density: exp, or for comparison softplus (as mip-NeRF) or relu (as NeRF); all start with the same "
       "density"},
      {"color_hidden_layers", &O::color_hidden_layers, Range{1, 3}, "hidden layers of the colour network"},
      {"sh_degree", &O::sh_degree, Range{1, 4}, "degree of the spherical harmonics of the viewing direction; 1: colour does not depend on it"},
      {"appearance_codes", &O::appearance_codes, Range{0, 32},
       "numbers of a code that is learned for every training photo and read by the colour network, so that photos of other light or weather need not "
       "agree; renderings and held-out photos show the mean look. Codes can hide differences of exposure that brightness.correction would measure; "
       "0: "
       "off"},
      {"appearance_of", &O::appearance_of, Range::OneOf({"photo", "folder"}),
       "photo: every photo has its own code; folder: photos of one folder share a code, such as those of one flight in one light; does nothing "
       "without appearance_codes"},
      {"refine_poses", &O::refine_poses, Range(),
       "true: the poses of training photos are refined while the context is trained, and blocks and products use the refined ones; held-out photos "
       "keep theirs. Needs encoding = hash or voxels"},
      {"pose_rate_px", &O::pose_rate_px, Range{1e-4, 1},
       "how far a step of its own moves a photo with refine_poses, about pixels as trained; it falls to a twentieth"},
      {"pose_sigma_px", &O::pose_sigma_px, Range{1e-2, 1e4},
       "standard deviation of the given poses with refine_poses, pixels as trained: photos that show little are held near them"},
      {"learning_rate", &O::learning_rate, Range{1e-6, 1}, "learning rate of Adam at the start"},
      {"final_learning_rate_share", &O::final_learning_rate_share, Range{1e-6, 1}, "learning rate at the end as a share of learning_rate"},
      {"sampler", &O::sampler, Range::OneOf({"occupancy", "proposal", "stratified"}),
       "how the samples of training rays are placed: occupancy (at even steps in occupied cells), or for comparison proposal (where two small "
       "density "
       "fields, which learn from the field, propose it) or stratified (a coarse pass, then a fine one where that found matter, as in NeRF)"},
      {"ray_samples", &O::ray_samples, Range{2, 512},
       "samples of a ray in each pass of the samplers proposal (one number per proposal field, then that of the field) and stratified (coarse, "
       "fine), "
       "such as [64, 64, 32]; empty: [64, 64, 32] and [64, 128]; does nothing with sampler = occupancy"},
      {"step_voxels", &O::step_voxels, Range{0.25, 16}, "distance between the samples of a ray in finest voxels"},
      {"stratified", &O::stratified, Range(),
       "true: the samples of a ray are shifted by a random part of a step, new for every ray; false: they are in the middle of the steps"},
      {"multisample", &O::multisample, Range::OneOf({0, 1, 4, 6}),
       "positions per sample. 1: samples have the footprint of their pixel, and detail finer than it fades, so that renderings from any distance "
       "show "
       "no flicker; 4 and 6: the same, spread over the footprint, slower; 0: samples are points"},
      {"scale_features", &O::scale_features, Range(),
       "true: the density network also sees how much the footprint leaves of the levels of the grid; does nothing with multisample = 0"},
      {"pyramid", &O::pyramid, Range{0, 1e6},
       "shares of the rays that are drawn from the photos at 1, 1/2, 1/4 and 1/8 of their size; one to four numbers of any sum. All rays come from "
       "the photos at full size with brightness.luminance_form = product"},
      {"pyramid_start", &O::pyramid_start, Range{0, 1e6}, "these shares at the start of the training; empty: as pyramid"},
      {"distortion", &O::distortion, Range{0, 100}, "weight of the distortion loss, which concentrates the density of a ray at one distance; 0: off"},
      {"empty_ray_share", &O::empty_ray_share, Range{0, 0.5},
       "share of a block's rays whose surface is behind the block, so that the block learns to be transparent there"},
      {"checkpoint_every_s", &O::checkpoint_every_s, Range{1e-3, 1e8}, "seconds between checkpoints"},
      {"diagnostics", &O::diagnostics, Range(),
       "true: write checkpoints/<field>.diagnostics.csv, a row per step: gradient and update norms, saturated colours and densities, samples that "
       "light reaches; to find out why a training falls apart"},
      {"coupling", &O::coupling, Range::OneOf({"guided", "independent"}),
       "guided: the context is rendered outside the block; independent: blocks are trained without it"},
      {"start", &O::start, Range::OneOf({"surfaces", "everywhere"}),
       "cells that a field samples first: surfaces (between the sparse points; blocks near the surfaces of the context) or everywhere (for "
       "comparison)"},
  };
}

std::vector<config::FixedOption> TrainOptions::Fixed() {
  return {{"pyramid_until", kPyramidUntil}, {"network_l2", kNetworkL2}};
}

void TrainOptions::Check(const std::string& section) const {
  config::CheckRanges(section, *this);
  for (const auto& [key, shares] : {std::pair{"pyramid", &pyramid}, std::pair{"pyramid_start", &pyramid_start}}) {
    const bool may_be_empty = shares == &pyramid_start;
    const bool usable = shares->size() <= kPyramidLevels && std::any_of(shares->begin(), shares->end(), [](double share) { return share > 0.0; });
    if (usable || (may_be_empty && shares->empty())) continue;
    throw base::UsageError(section + "." + key +
                           " is not allowed: give one to four shares, of which at least one is above 0, such as [0.6, 0.2, 0.12, 0.08]");
  }
  const bool whole = std::all_of(ray_samples.begin(), ray_samples.end(), [](double n) { return n == std::floor(n); });
  const bool passes = sampler == "stratified" ? ray_samples.size() == 2 : ray_samples.size() >= 2 && ray_samples.size() <= 4;
  if (!ray_samples.empty() && !(whole && passes)) {
    throw base::UsageError(section +
                           ".ray_samples is not allowed: give whole numbers, two for the sampler stratified, such as [64, 128], and two to "
                           "four for proposal, such as [64, 64, 32]");
  }
  if (refine_poses && encoding != "hash" && encoding != "voxels") {
    throw base::UsageError(section + ".refine_poses = true is not allowed with " + section + ".encoding = \"" + encoding +
                           "\", which has no derivatives by position: choose \"hash\" or \"voxels\", or refine_poses = false");
  }
  if (levels * features % 4 != 0) {
    throw base::UsageError(section + ".levels = " + std::to_string(levels) + " is not allowed with " + section +
                           ".features = " + std::to_string(features) + ": their product must be a multiple of 4");
  }
}

}  // namespace skyquilt::worker
