// Divides a survey into blocks: finds the area, makes the grid, and computes every block's height, table size, photos and cost.
#pragma once

#include <limits>

#include "core/survey/survey.h"
#include "partition/block.h"
#include "partition/partition_options.h"

namespace skyquilt::partition {

// A block without sparse points, or seen by fewer than two training photos, is marked empty with a reason and has no photos, table or cost.
// Block::cost is the geometric mean of training pixels (what the block must explain) and surface voxels of the finest level (what it must store),
// scaled so that all blocks sum to 1.
//   image_width  training width in pixels, 0 = full size
//   block_steps  optimiser steps that all blocks together get in the time there is (auto_grid.h); infinite: time limits nothing
// Deterministic. Throws base::UsageError for options that cannot be used (see PartitionOptions::Check; also when the number of altitudes is not the
// number of blocks) and base::InputError when the survey has no area or every block is empty.
BlockSet MakeBlocks(const survey::Survey& survey, const PartitionOptions& options, int image_width,
                    double block_steps = std::numeric_limits<double>::infinity());

// Blocks of a survey to which photos were added behind the others: those of `earlier`, which keep box, name and margin, and others of about their
// size around them, as far as the area reaches now but for strips of a quarter of their size. Rows and columns before the first one have negative
// numbers (r-1c0). A block whose box is seen by the same photos as before is the same to the last bit, but for its cost and id; others get height,
// table size and photos anew. Throws as MakeBlocks, and base::UsageError for given altitudes and for photos so far away that there would be more than
// kMaxBlocks.
BlockSet ExtendBlocks(const survey::Survey& survey, const BlockSet& earlier, const PartitionOptions& options);

}  // namespace skyquilt::partition
