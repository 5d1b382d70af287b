// From a survey to its blocks: area, grid, altitude, capacity and visibility in one call.
#pragma once

#include "core/survey/survey.h"
#include "partition/block.h"
#include "partition/partition_options.h"

namespace skyquilt::partition {

// Deterministic. A block without sparse points, or that fewer than two training photos see, is named, marked empty with its reason and given
// no photos, table or cost. Block::cost is the geometric mean of what a block has to explain (training pixels) and what it has to store
// (voxels its surface crosses at the finest level), scaled so that all blocks sum to 1.
// image_width: training width in pixels, 0 = full size.
// Throws base::UsageError for invalid requests (altitude count against block count, both named; see PartitionOptions::Check) and
// base::InputError when the survey has no area or every block is empty.
BlockSet MakeBlocks(const survey::Survey& survey, const PartitionOptions& options, int image_width);

}  // namespace skyquilt::partition
