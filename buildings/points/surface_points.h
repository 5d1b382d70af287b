// Points of the finished surface with what is needed to find buildings, and heights of the bare ground below them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "surface/map_frame.h"

namespace skyquilt::buildings {

struct SurfacePoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  // ENU relative to PointCloud::middle, metres
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();    // length 1, ENU, out of the surface
  std::array<uint8_t, 3> rgb = {};
  uint8_t views = 0;   // photos and virtual views that saw it
  uint8_t filled = 0;  // 1: closes a gap of the surface: no measurement
};

struct PointCloud {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  // ENU
  std::vector<SurfacePoint> points;
  double spacing_m = 0.0;  // about one point per spacing_m^2 of surface

  Eigen::Vector3d At(size_t i) const { return middle + points[i].position.cast<double>(); }
};

// Height of the bare ground at the nodes of a grid along east and north (not in cells, as of geo::PlaneGrid); bilinear between nodes.
class GroundGrid {
 public:
  // height_z: [row][column], ENU z at origin + cell_m * (column, row); NaN: none.
  GroundGrid(const Eigen::Vector2d& origin, double cell_m, int columns, int rows, std::vector<float> height_z);
  // dtm.tif of the surface, resampled in ENU. Throws base::InputError.
  static GroundGrid Read(const std::filesystem::path& dtm_tif, const surface::MapFrame& frame);

  // NaN outside and where there is none.
  double At(const Eigen::Vector2d& enu) const;
  Eigen::Vector2d min() const { return origin_; }
  Eigen::Vector2d max() const { return origin_ + cell_m_ * Eigen::Vector2d(columns_ - 1, rows_ - 1); }
  double cell_m() const { return cell_m_; }

 private:
  Eigen::Vector2d origin_;
  double cell_m_;
  int columns_, rows_;
  std::vector<float> height_z_;
};

// The points that the surface stage kept for its cloud, in the order of the cloud. Throws base::InputError when they are missing (surface.cloud was
// off) or damaged; the message says what to do.
PointCloud LoadSurfacePoints(const std::filesystem::path& surface_work_folder, double spacing_m);

}  // namespace skyquilt::buildings
