// What a block's field must be able to hold: from the ground sampling distance and the surface inside.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/survey/survey.h"
#include "partition/partition_options.h"
#include "partition/survey_area.h"

namespace skyquilt::partition {

// Metres per pixel of the camera that took most photos, `agl_m` above the ground, on images reduced to image_width (0 or more than the
// camera has: full size).
double SurveyGsd(const survey::Survey& survey, double agl_m, int image_width);

// Area of walls and slopes per area of ground, [0, 4]: mean height step between neighbouring cells of a raster of the points over the cell
// size. 0 for flat ground, about 1 for dense streets of houses as wide as they are high.
double Roughness(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low, const Eigen::Vector2d& high);

// Voxels of the finest level that the surface crosses: covered ground (at least a twentieth of the rectangle) / voxel^2 * (1 + roughness).
double SurfaceVoxels(const SurveyArea& area, const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                     double voxel_m);

// log2 of the table whose entries are nearest to the voxels, within the limits of the options.
int Log2TableSize(double surface_voxels, const PartitionOptions& options);

}  // namespace skyquilt::partition
