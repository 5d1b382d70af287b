// The parts of project.json about files: surface, maps, photos, scores. Each says in "missing" what is not there.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "partition/block.h"
#include "viewer/data/open_project.h"
#include "viewer/data/opening.h"

namespace skyquilt::viewer::opening {

// surface, tiles, contours.
void DescribeSurface(OpenedProject* opened);
// terrain and orthophoto, which are shown where there is no surface. After DescribeSurface, and once the place is known.
void DescribeMaps(OpenedProject* opened);
// metrics: metrics.json.
void DescribeBlocks(OpenedProject* opened, const std::optional<partition::BlockSet>& blocks, const nlohmann::json& metrics);
// cameras, photos, points.
void DescribePhotos(OpenedProject* opened, const nlohmann::json& metrics);
void DescribeMetrics(OpenedProject* opened, const JsonFile& file);

}  // namespace skyquilt::viewer::opening
