// How large a block's hash tables must be, from the ground sampling distance and the area of surface inside the block. Too small a table blurs,
// too large a one costs time and memory.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/survey/survey.h"
#include "partition/partition_options.h"
#include "partition/survey_area.h"

namespace skyquilt::partition {

// Metres per pixel of a camera at this distance, for images scaled down to image_width pixels (full size if that is 0 or more than the camera has).
double TrainingGsd(const camera::Camera& camera, double distance_m, int image_width);
// The same of the camera that took most training photos, `agl_m` above the ground.
double SurveyGsd(const survey::Survey& survey, double agl_m, int image_width);

// Estimated area of walls and slopes per area of ground, in [0, 4]: the mean height difference between neighbouring cells of a raster of the points,
// divided by the cell size. 0 for flat ground, about 1 for dense streets with houses as wide as they are high.
double Roughness(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low, const Eigen::Vector2d& high);

// Number of finest voxels that the surface crosses: covered ground (at least a twentieth of the rectangle) / voxel_m^2 * (1 + roughness).
double SurfaceVoxels(const SurveyArea& area, const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                     double voxel_m);

// log2 of the table size nearest to surface_voxels / voxels_per_entry, within the limits of the options.
int Log2TableSize(double surface_voxels, const PartitionOptions& options);

}  // namespace skyquilt::partition
