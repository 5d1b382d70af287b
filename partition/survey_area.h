// The rectangle of ground that a survey can reconstruct, and how well each part of it is seen.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::partition {

// Points fit for measuring: finite, and seen by at least three photos as long as enough of those exist.
std::vector<Eigen::Vector3d> ReliablePoints(const survey::Survey& survey);

// Height of the ground on a coarse raster: median of the points of a cell, the overall median where there are none.
class GroundRaster {
 public:
  GroundRaster(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, int cells);
  double At(double x, double y) const;  // metres; the nearest cell outside the raster
  double median() const { return median_; }

 private:
  Eigen::Vector2d min_enu_;
  Eigen::Vector2d cell_;
  int cells_;
  double median_;
  std::vector<double> height_;
};

struct SurveyArea {
  Eigen::Vector2d min_enu = Eigen::Vector2d::Zero();  // the rectangle to cut into blocks, metres
  Eigen::Vector2d max_enu = Eigen::Vector2d::Zero();
  double ground_m = 0.0;  // median height of the points
  // Coverage raster over the bounds of the points, somewhat widened; row-major from the south-west.
  Eigen::Vector2d raster_min = Eigen::Vector2d::Zero();
  Eigen::Vector2d raster_cell = Eigen::Vector2d::Ones();
  int raster_columns = 0;
  int raster_rows = 0;
  std::vector<char> covered;

  // Covered ground inside a rectangle, square metres; cells count by the part of them that lies inside.
  double CoveredArea(const Eigen::Vector2d& low, const Eigen::Vector2d& high) const;
};

// `rule`: "covered" or "points" (see PartitionOptions::area). A place counts as seen by a photo when it projects into the image from no
// farther than three times the height of flight: beyond, oblique views blur into the horizon.
// Throws base::InputError when there are fewer than two photos or four usable points, or when the points have no extent.
SurveyArea FindSurveyArea(const survey::Survey& survey, const std::vector<Eigen::Vector3d>& points, const std::string& rule, int min_views);

}  // namespace skyquilt::partition
