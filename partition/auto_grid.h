// The grid of blocks for blocks = "auto": as few blocks as hold the surface in their tables, but no more than pixels and time can train.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <string>

#include "partition/block_grid.h"

namespace skyquilt::partition {

// Photos that must show a surface voxel, in pixels of the ground sampling distance, for a block to learn it: 18 * 2^17 training pixels fill a block
// with the default tables of 2^17 entries, of which each holds 4 voxels that are 1.5 pixels wide.
constexpr double kViewsOfVoxel = 2.0;
// Optimiser steps of a block, on average; after fewer, larger blocks look better, because each gets the steps of several.
constexpr double kBlockSteps = 1500.0;
// Steps of the block that gets least: those at the border of a survey have a small share of the time.
constexpr double kFewestSteps = 500.0;

struct AutoGridInput {
  Eigen::Vector2d min_enu = Eigen::Vector2d::Zero();  // the rectangle to divide, metres
  Eigen::Vector2d max_enu = Eigen::Vector2d::Ones();
  std::function<bool(const BlockGrid&)> fits;           // no block has more surface than its table holds
  std::function<int(const BlockGrid&)> n_blocks;        // that have something to train
  std::function<double(const BlockGrid&)> least_share;  // of the training time, of these; called only with a time limit
  double training_pixels = 0.0;
  double pixels_per_block = 1.0;
  double block_steps = std::numeric_limits<double>::infinity();  // of all blocks together in the time there is; infinite: no limit
};

struct AutoGrid {
  BlockGrid grid;
  std::string reason;  // which limit decided, to follow "2 x 3 blocks: "
};

// More steps or pixels never give fewer blocks. At least one block, whatever the limits.
AutoGrid ChooseGrid(const AutoGridInput& input);

}  // namespace skyquilt::partition
