#include "partition/capacity.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"

namespace skyquilt::partition {
namespace {

const camera::Camera& CommonCamera(const survey::Survey& survey) {
  std::vector<int> uses(survey.cameras.size(), 0);
  for (const survey::Photo& photo : survey.photos) {
    if (!photo.is_test) ++uses.at(static_cast<size_t>(photo.camera));
  }
  return survey.cameras.at(static_cast<size_t>(std::max_element(uses.begin(), uses.end()) - uses.begin()));
}

}  // namespace

double TrainingGsd(const camera::Camera& camera, double distance_m, int image_width) {
  if (image_width <= 0 || image_width >= camera.width) return camera::GroundSamplingDistance(camera, distance_m);
  const int height = std::max(1, static_cast<int>(std::lround(static_cast<double>(camera.height) * image_width / camera.width)));
  return camera::GroundSamplingDistance(camera.Resized(image_width, height), distance_m);
}

double SurveyGsd(const survey::Survey& survey, double agl_m, int image_width) {
  return TrainingGsd(CommonCamera(survey), agl_m, image_width);
}

double Roughness(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low, const Eigen::Vector2d& high) {
  constexpr double kPointsPerCell = 8.0;
  constexpr double kMostCells = 64.0;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<const Eigen::Vector3d*> inside;
  for (const Eigen::Vector3d& x : points) {
    if ((x.head<2>().array() >= low.array()).all() && (x.head<2>().array() < high.array()).all()) inside.push_back(&x);
  }
  const auto cells = static_cast<int>(std::clamp(std::sqrt(static_cast<double>(inside.size()) / kPointsPerCell), 1.0, kMostCells));
  if (cells < 2) return 0.0;
  const Eigen::Array2d cell = (high - low).array() / cells;
  std::vector<std::vector<double>> heights(static_cast<size_t>(cells) * static_cast<size_t>(cells));
  for (const Eigen::Vector3d* x : inside) {
    const Eigen::Array2d place = ((x->head<2>() - low).array() / cell).floor().min(cells - 1);
    heights[static_cast<size_t>(place.y()) * static_cast<size_t>(cells) + static_cast<size_t>(place.x())].push_back(x->z());
  }
  std::vector<double> median;
  median.reserve(heights.size());
  for (std::vector<double>& values : heights) median.push_back(base::Median(std::move(values)));
  const auto at = [&](int row, int column) { return median[static_cast<size_t>(row) * static_cast<size_t>(cells) + static_cast<size_t>(column)]; };
  Eigen::Array2d sum(0.0, 0.0);
  Eigen::Array2d count(0.0, 0.0);
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      const double step_x = column + 1 < cells ? std::abs(at(row, column + 1) - at(row, column)) : kNone;
      const double step_y = row + 1 < cells ? std::abs(at(row + 1, column) - at(row, column)) : kNone;
      if (std::isfinite(step_x)) {
        sum.x() += step_x;
        count.x() += 1.0;
      }
      if (std::isfinite(step_y)) {
        sum.y() += step_y;
        count.y() += 1.0;
      }
    }
  }
  const Eigen::Array2d slope = sum / count.max(1.0) / cell;
  return std::clamp(slope.sum(), 0.0, 4.0);
}

double SurfaceVoxels(const SurveyArea& area, const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low, const Eigen::Vector2d& high,
                     double voxel_m) {
  SKYQUILT_CHECK(voxel_m > 0.0, std::to_string(voxel_m));
  // At least a twentieth: margins may extend beyond the raster, and the coverage test ignores relief.
  const double ground = std::max(area.CoveredArea(low, high), 0.05 * (high - low).prod());
  return ground / (voxel_m * voxel_m) * (1.0 + Roughness(points, low, high));
}

int Log2TableSize(double surface_voxels, const PartitionOptions& options) {
  const double exact = std::log2(std::max(1.0, surface_voxels / options.voxels_per_entry));
  return static_cast<int>(
      std::lround(std::clamp(exact, static_cast<double>(options.min_log2_table_size), static_cast<double>(options.max_log2_table_size))));
}

}  // namespace skyquilt::partition
