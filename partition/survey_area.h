// The rectangle of ground that the training photos cover well enough to reconstruct, and a raster of which parts of it are covered.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/survey/survey.h"

namespace skyquilt::partition {

// Finite sparse points, only those observed by at least three training photos if there are enough of them. ENU metres.
std::vector<Eigen::Vector3d> ReliablePoints(const survey::Survey& survey);

// Height of the ground on a coarse raster: median of the points of a cell, the overall median in cells with fewer than three points.
class GroundRaster {
 public:
  GroundRaster(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, int cells);
  double At(double x, double y) const;  // metres; outside the raster that of the nearest cell
  double median() const { return median_; }

 private:
  Eigen::Vector2d min_enu_;
  Eigen::Vector2d cell_;
  int cells_;
  double median_;
  std::vector<double> height_;
};

struct SurveyArea {
  Eigen::Vector2d min_enu = Eigen::Vector2d::Zero();  // the rectangle to divide into blocks, metres
  Eigen::Vector2d max_enu = Eigen::Vector2d::Zero();
  double ground_m = 0.0;  // median height of the points
  // Coverage raster over slightly more than the bounds of the points; row-major from the south-west.
  Eigen::Vector2d raster_min = Eigen::Vector2d::Zero();
  Eigen::Vector2d raster_cell = Eigen::Vector2d::Ones();
  int raster_columns = 0;
  int raster_rows = 0;
  std::vector<char> covered;  // 1 where enough training photos see the ground
  bool by_points = false;     // they see none of it: the rectangle is that of the points, and all of it counts as covered

  // Covered ground inside a rectangle, square metres. Cells partly inside count with that part.
  double CoveredArea(const Eigen::Vector2d& low, const Eigen::Vector2d& high) const;
};

// `rule`: "covered" or "points" (see PartitionOptions::area). A photo sees a piece of ground when it projects into the image and is no farther away
// than three times the flying height; beyond that, oblique views are too coarse. A photo that looks level reaches as far as 95 % of the points that
// it observed. Throws base::InputError when there are fewer than two training photos or four usable points, or when the points have no extent.
SurveyArea FindSurveyArea(const survey::Survey& survey, const std::vector<Eigen::Vector3d>& points, const std::string& rule, int min_views);

}  // namespace skyquilt::partition
