#include "buildings/candidates/piece_kind.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "buildings/candidates/top_raster.h"
#include "core/base/order_statistics.h"
#include "core/linear/linear.h"

namespace skyquilt::buildings {
namespace {

constexpr double kLeastRoof_m2 = 4.0;
constexpr double kSteepestRoof = 0.42;      // normal.z: 65 degrees, for roofs of 60 with errors
constexpr double kSteepStrip = 0.77;        // below it (40 degrees) narrow strips are rounded edges of walls
constexpr double kLeastStrip_m = 1.2;       // width seen from above
constexpr double kGreenRoof_m2 = 25.0;      // lawns on roofs, copper, painted metal: large, even and planar
constexpr double kGreenRoofRms = 0.3;       // of the planes' tolerance
constexpr double kGreenRoofNormals = 0.98;  // length of the mean of the normals: 1 when all are the same
constexpr double kLeastNormals = 0.87;      // of smaller pieces, about 30 degrees: the surfaces of crowns turn more

// Of the rectangle with the same variance across, seen from above.
double PlanWidth(const RoofPlane& plane, const PointCloud& cloud) {
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const uint32_t i : plane.points) {
    const Eigen::Vector2d d = (cloud.At(i) - plane.middle).head<2>();
    covariance += d * d.transpose();
  }
  covariance /= static_cast<double>(plane.points.size());
  return std::sqrt(12.0 * std::max(linear::SymmetricEigen(covariance).values[0], 0.0));
}

}  // namespace

PlanePiece JudgePiece(RoofPlane plane, const PointCloud& cloud, const GroundGrid& ground, const BuildingsOptions& options, double plane_distance_m) {
  PlanePiece piece;
  piece.plane = std::move(plane);
  std::vector<double> heights, greens;
  Eigen::Vector3d normals = Eigen::Vector3d::Zero();
  for (const uint32_t i : piece.plane.points) {
    const Eigen::Vector3d at = cloud.At(i);
    const double height = at.z() - ground.At(at.head<2>());
    if (!std::isnan(height)) heights.push_back(height);
    greens.push_back(ExcessGreen(cloud.points[i]));
    normals += cloud.points[i].normal.cast<double>();
  }
  piece.height_m = base::Median(std::move(heights));
  if (!(piece.height_m >= options.min_height_m) || piece.plane.normal.z() < kSteepestRoof) return piece;
  if (piece.plane.normal.z() < kSteepStrip && PlanWidth(piece.plane, cloud) < kLeastStrip_m) return piece;
  const double evenness = normals.norm() / static_cast<double>(piece.plane.points.size());
  if (piece.plane.area_m2 < kGreenRoof_m2 && evenness < kLeastNormals) return piece;
  if (base::Median(std::move(greens)) > options.max_green) {
    piece.green = piece.plane.area_m2 >= kGreenRoof_m2 && piece.plane.rms_m <= kGreenRoofRms * plane_distance_m && evenness >= kGreenRoofNormals;
    if (!piece.green) return piece;
  }
  piece.kind = piece.plane.area_m2 >= kLeastRoof_m2 ? PieceKind::kRoof : PieceKind::kAttached;
  return piece;
}

}  // namespace skyquilt::buildings
