// Options for training one field. [context] has them for the coarse field of the whole survey, [train] for every block: both are trained by the same
// code, with different budgets; what [context] does not name it has from [train]. Allowed values are in Fields(), and are shown in the written
// configuration.
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"
#include "worker/poses/pose_options.h"

namespace skyquilt::worker {

struct TrainOptions {
  // Budget. With both 0: kDefaultSteps.
  int steps = 0;         // optimiser steps; 0: `seconds` decides
  double seconds = 0.0;  // training time of this field

  int batch_samples = 32768;  // samples per step; the number of rays per step adapts to it

  // Encoding of positions (core/encoding) and networks (core/field).
  std::string encoding = "hash";  // hash, voxels, planes or frequency
  int levels = 8;                 // resolutions of the hash grid
  int features = 4;               // numbers per entry of the hash grid
  int base_resolution = 16;       // cells along the longest edge at the coarsest level; the finest one follows from the block's voxel size
  int hidden = 64;                // width of the hidden layers of both networks
  int density_hidden_layers = 1;
  std::string density_activation = "exp";  // exp, softplus or relu (core/field/density_activation.h)
  int color_hidden_layers = 1;
  int sh_degree = 3;                    // of the spherical harmonics of the viewing direction; 1: colour does not depend on it
  int appearance_codes = 0;             // numbers of the code of every training photo (worker/step/appearance_codes.h); 0: off
  std::string appearance_of = "photo";  // photo or folder: which photos share a code
  bool refine_poses = false;            // of training photos, while the context is trained (worker/poses/pose_learner.h)
  double pose_rate_px = 0.02;           // PoseLearnerOptions::rate_px
  double pose_sigma_px = 2.0;           // PoseLearnerOptions::sigma_px

  // Adam. The rate rises over the first 50 steps, then is constant, then falls geometrically.
  double learning_rate = 3e-2;             // highest rate
  double final_learning_rate_share = 0.1;  // rate at the end divided by learning_rate

  // Rays and losses.
  std::string sampler = "occupancy";     // worker/samplers/bin_sampler.h
  std::vector<double> ray_samples = {};  // per pass of a sampler of bins; empty: its own numbers
  double step_voxels = 2.0;              // distance between the samples of a ray, in finest voxels
  bool stratified = true;                // samples of a ray are shifted by a random part of a step
  int multisample = 1;                   // positions per sample: 1, 4 or 6; 0: samples are points, without footprint (core/render/footprint.h)
  bool scale_features = true;            // the density network also sees the footprint's weight of every level
  // Shares of the rays from photos at 1, 1/2, 1/4 and 1/8 (worker/rays/photo_pyramid.h), and how they change.
  std::vector<double> pyramid = {0.6, 0.18, 0.11, 0.11};
  std::vector<double> pyramid_start = {0.9, 0.05, 0.025, 0.025};
  double distortion = 1e-2;       // weight of the distortion loss (worker/losses/distortion_loss.h)
  double empty_ray_share = 0.05;  // share of a block's rays whose surface is behind the block: it must be transparent there

  double checkpoint_every_s = 20.0;
  bool diagnostics = false;         // write worker/train_diagnostics.h beside the log
  std::string coupling = "guided";  // guided: blocks render the context outside their ground plan; independent: they do not use its field
  std::string start = "surfaces";   // cells that are sampled first: near known surfaces, or everywhere that photos see

  PoseLearnerOptions PoseOptions() const { return {refine_poses, pose_rate_px, pose_sigma_px}; }

  static std::vector<config::Field<TrainOptions>> Fields();
  static std::vector<config::FixedOption> Fixed();
  // Throws base::UsageError that names the option and its rule. section: "context" or "train".
  void Check(const std::string& section) const;
};

// Share of the budget in which the pyramid changes from its start to its end: all of it, as reduced photos teach most when the shapes are known.
constexpr double kPyramidUntil = 1.0;
// Weight decay of the networks. 1e-4 costs 0.1 dB (docs/experiments/brighton-beach.md).
constexpr double kNetworkL2 = 1e-6;

// Steps per field when neither steps nor seconds is set.
constexpr int kDefaultSteps = 2000;

}  // namespace skyquilt::worker
