#include "partition/survey_area.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/errors.h"
#include "core/base/order_statistics.h"
#include "core/camera/photo_visibility.h"
#include "core/survey/seen_distance.h"

namespace skyquilt::partition {
namespace {

constexpr int kRasterCells = 96;             // along the longer side
constexpr double kSearchBeyondPoints = 0.1;  // of the points' extent, on each side
constexpr int kGroundCells = 16;
constexpr double kMaxSlantPerAgl = 3.0;

std::vector<double> Coordinate(const std::vector<Eigen::Vector3d>& points, int axis) {
  std::vector<double> values;
  values.reserve(points.size());
  for (const Eigen::Vector3d& x : points) values.push_back(x[axis]);
  return values;
}

// Training photos per raster cell.
std::vector<int> CountViews(const survey::Survey& survey, const SurveyArea& area, const GroundRaster& ground) {
  std::vector<Eigen::Vector3d> centres;
  for (int row = 0; row < area.raster_rows; ++row) {
    for (int column = 0; column < area.raster_columns; ++column) {
      const Eigen::Vector2d x = area.raster_min + area.raster_cell.cwiseProduct(Eigen::Vector2d(column + 0.5, row + 0.5));
      centres.emplace_back(x.x(), x.y(), ground.At(x.x(), x.y()));
    }
  }
  std::vector<int> views(centres.size(), 0);
  const std::vector<std::optional<survey::SeenDistance>> seen = survey::DistancesOfLevelPhotos(survey);
  for (size_t p = 0; p < survey.photos.size(); ++p) {
    const survey::Photo& photo = survey.photos[p];
    if (photo.is_test) continue;
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
    const Eigen::Vector3d eye = photo.cam_from_enu.OriginInSource();
    const double agl = eye.z() - ground.At(eye.x(), eye.y());
    camera::VisibilityRule rule{.far_edges = true};
    if (seen[p]) {
      rule.reach_m = seen[p]->far_m;
    } else if (agl > 0.0) {
      rule.reach_m = kMaxSlantPerAgl * agl;
    }
    for (size_t i = 0; i < centres.size(); ++i) {
      if (camera::IsVisible(camera, photo.cam_from_enu, centres[i], rule)) ++views[i];
    }
  }
  return views;
}

}  // namespace

std::vector<Eigen::Vector3d> ReliablePoints(const survey::Survey& survey) {
  constexpr size_t kEnough = 100;
  std::vector<Eigen::Vector3d> finite;
  std::vector<Eigen::Vector3d> confirmed;
  for (const survey::SparsePoint& point : survey.points) {
    if (!point.x_in_enu.allFinite()) continue;
    finite.push_back(point.x_in_enu);
    if (point.track_length >= 3) confirmed.push_back(point.x_in_enu);
  }
  return confirmed.size() >= std::max(kEnough, finite.size() / 3) ? confirmed : finite;
}

GroundRaster::GroundRaster(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& min_enu, const Eigen::Vector2d& max_enu, int cells)
    : min_enu_(min_enu),
      cell_((max_enu - min_enu) / cells),
      cells_(cells),
      median_(base::Median(Coordinate(points, 2))),
      height_(static_cast<size_t>(cells) * static_cast<size_t>(cells), median_) {
  std::vector<std::vector<double>> heights(height_.size());
  for (const Eigen::Vector3d& x : points) {
    const Eigen::Array2d place = ((x.head<2>() - min_enu_).array() / cell_.array()).floor();
    if ((place < 0.0).any() || (place >= cells).any()) continue;
    heights[static_cast<size_t>(place.y()) * static_cast<size_t>(cells_) + static_cast<size_t>(place.x())].push_back(x.z());
  }
  for (size_t i = 0; i < heights.size(); ++i) {
    if (heights[i].size() >= 3) height_[i] = base::Median(std::move(heights[i]));
  }
}

double GroundRaster::At(double x, double y) const {
  const double last = cells_ - 1;
  const double column = std::clamp(std::floor((x - min_enu_.x()) / cell_.x()), 0.0, last);
  const double row = std::clamp(std::floor((y - min_enu_.y()) / cell_.y()), 0.0, last);
  return height_[static_cast<size_t>(row) * static_cast<size_t>(cells_) + static_cast<size_t>(column)];
}

double SurveyArea::CoveredArea(const Eigen::Vector2d& low, const Eigen::Vector2d& high) const {
  double sum = 0.0;
  for (int row = 0; row < raster_rows; ++row) {
    const double south = raster_min.y() + row * raster_cell.y();
    const double tall = std::min(south + raster_cell.y(), high.y()) - std::max(south, low.y());
    if (tall <= 0.0) continue;
    for (int column = 0; column < raster_columns; ++column) {
      if (!covered[static_cast<size_t>(row) * static_cast<size_t>(raster_columns) + static_cast<size_t>(column)]) continue;
      const double west = raster_min.x() + column * raster_cell.x();
      const double wide = std::min(west + raster_cell.x(), high.x()) - std::max(west, low.x());
      if (wide > 0.0) sum += wide * tall;
    }
  }
  return sum;
}

SurveyArea FindSurveyArea(const survey::Survey& survey, const std::vector<Eigen::Vector3d>& points, const std::string& rule, int min_views) {
  const std::filesystem::path name = survey.photo_root.empty() ? std::filesystem::path("survey") : survey.photo_root;
  const auto n_training = std::count_if(survey.photos.begin(), survey.photos.end(), [](const survey::Photo& photo) { return !photo.is_test; });
  if (n_training < 2) {
    throw base::InputError(name, "the survey has " + std::to_string(n_training) + " photo(s) with a pose that are not held out",
                           "Run `skyquilt prepare` with at least two photos that see the same ground, or hold out fewer");
  }
  if (points.size() < 4) {
    throw base::InputError(name, "the survey has " + std::to_string(points.size()) + " usable sparse points",
                           "At least 4 are needed to find the area: run `skyquilt prepare` again with a model that contains points3D");
  }
  SurveyArea area;
  for (int axis = 0; axis < 2; ++axis) {
    const std::vector<double> values = Coordinate(points, axis);
    const double low = base::Quantile(values, 0.01);
    const double high = base::Quantile(values, 0.99);
    // 2 % on each side restore what the percentiles cut off evenly spread points. Points are sparse near the rim, where few photos overlap, so
    // the search for covered ground extends farther.
    const double widening = rule == "covered" ? kSearchBeyondPoints : 0.02;
    area.min_enu[axis] = low - widening * (high - low);
    area.max_enu[axis] = high + widening * (high - low);
  }
  const Eigen::Vector2d extent = area.max_enu - area.min_enu;
  if (!(extent.minCoeff() > 0.0)) {
    throw base::InputError(name, "all sparse points are on one line or in one spot", "Prepare again with photos from different positions");
  }
  const GroundRaster ground(points, area.min_enu, area.max_enu, kGroundCells);
  area.ground_m = ground.median();
  area.raster_min = area.min_enu;
  const double cell = extent.maxCoeff() / kRasterCells;
  area.raster_columns = std::max(4, static_cast<int>(std::ceil(extent.x() / cell)));
  area.raster_rows = std::max(4, static_cast<int>(std::ceil(extent.y() / cell)));
  area.raster_cell = extent.cwiseQuotient(Eigen::Vector2d(area.raster_columns, area.raster_rows));

  const int needed = std::min(min_views, static_cast<int>(n_training));
  const std::vector<int> views = CountViews(survey, area, ground);
  std::vector<double> x_covered;
  std::vector<double> y_covered;
  area.covered.resize(views.size());
  for (size_t i = 0; i < views.size(); ++i) {
    area.covered[i] = views[i] >= needed ? 1 : 0;
    if (!area.covered[i]) continue;
    x_covered.push_back(static_cast<double>(i % static_cast<size_t>(area.raster_columns)));
    y_covered.push_back(static_cast<double>(i / static_cast<size_t>(area.raster_columns)));
  }
  if (x_covered.empty()) {
    // No photo sees the ground at its estimated height.
    area.by_points = true;
    std::fill(area.covered.begin(), area.covered.end(), char{1});
    return area;
  }
  if (rule == "covered") {
    const Eigen::Vector2d low(std::floor(base::Quantile(x_covered, 0.005)), std::floor(base::Quantile(y_covered, 0.005)));
    const Eigen::Vector2d high(std::ceil(base::Quantile(x_covered, 0.995)) + 1.0, std::ceil(base::Quantile(y_covered, 0.995)) + 1.0);
    area.min_enu = area.raster_min + area.raster_cell.cwiseProduct(low);
    area.max_enu = area.raster_min + area.raster_cell.cwiseProduct(high);
  }
  return area;
}

}  // namespace skyquilt::partition
