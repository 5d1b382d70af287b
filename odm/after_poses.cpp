#include "odm/after_poses.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <vector>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/order_statistics.h"
#include "core/geo/enu_frame.h"
#include "core/gis/boundary.h"
#include "odm/report/shots.h"

namespace skyquilt::odm {
namespace {

using Points = std::vector<Eigen::Vector2d>;

// Counter-clockwise, without points on its edges (Andrew's monotone chain).
Points ConvexHull(Points points) {
  std::sort(points.begin(), points.end(),
            [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  Points hull;
  const auto turns_right = [&hull](const Eigen::Vector2d& next) {
    const Eigen::Vector2d &a = hull[hull.size() - 2], &b = hull.back();
    return (b.x() - a.x()) * (next.y() - a.y()) - (b.y() - a.y()) * (next.x() - a.x()) <= 0.0;
  };
  for (int side = 0; side < 2; ++side) {
    const size_t begin = hull.size();
    for (const Eigen::Vector2d& point : points) {
      while (hull.size() >= begin + 2 && turns_right(point)) hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();  // the first point of the other side
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

// The hull of discs of this radius about the points, their circles as polygons of 32 corners.
Points Widened(const Points& points, double radius) {
  constexpr int kCorners = 32;
  Points corners;
  for (const Eigen::Vector2d& point : points) {
    for (int i = 0; i < kCorners; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kCorners;
      corners.push_back(point + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  return ConvexHull(std::move(corners));
}

}  // namespace

double PhotoGsd(const survey::Survey& survey) {
  std::vector<double> sizes;
  for (const survey::Photo& photo : survey.photos) {
    if (photo.agl_m > 0.0) sizes.push_back(camera::GroundSamplingDistance(survey.cameras[static_cast<size_t>(photo.camera)], photo.agl_m));
  }
  return sizes.empty() ? std::numeric_limits<double>::quiet_NaN() : base::Median(sizes);
}

MapCells CellsOf(const Request& request, const survey::Survey& survey) {
  const double gsd_m = request.Has("--ignore-gsd") ? 0.0 : PhotoGsd(survey);
  const auto cell = [&](const char* option) {
    const double wanted_m = 0.01 * request.Number(option);
    return 1e-4 * std::max(1.0, std::round(1e4 * (gsd_m > wanted_m ? gsd_m : wanted_m)));
  };
  return {.orthophoto_m = cell("--orthophoto-resolution"), .heights_m = cell("--dem-resolution")};
}

void WriteAutoBoundary(const survey::Survey& survey, double distance_m, const std::filesystem::path& file) {
  Points cameras;
  for (const survey::Photo& photo : survey.photos) cameras.emplace_back(photo.cam_from_enu.OriginInSource().head<2>());
  const double agl_m = survey.MedianAgl();
  const double widen_m = distance_m > 0.0 ? distance_m : 0.5 * agl_m;
  if (cameras.empty() || !(widen_m > 0.0)) {
    throw base::InputError(file, "cannot be made: the flying height is not known", "Give --auto-boundary-distance, or leave --auto-boundary out");
  }
  nlohmann::json ring = nlohmann::json::array();
  const auto add = [&](const Eigen::Vector2d& corner) {
    if (survey.georeferenced) {
      const geo::EnuFrame frame(survey.origin);
      const geo::Geodetic place = frame.GeodeticFromEnu({corner.x(), corner.y(), 0.0});
      ring.push_back({place.longitude_deg, place.latitude_deg});
    } else {
      ring.push_back({corner.x(), corner.y()});
    }
  };
  const Points hull = Widened(cameras, widen_m);
  for (const Eigen::Vector2d& corner : hull) add(corner);
  add(hull.front());
  const nlohmann::json feature = {{"type", "Feature"},
                                  {"properties", nlohmann::json::object()},
                                  {"geometry", {{"type", "Polygon"}, {"coordinates", nlohmann::json::array({ring})}}}};
  const std::string text = base::JsonText(nlohmann::json{{"type", "FeatureCollection"}, {"features", nlohmann::json::array({feature})}}) + "\n";
  if (std::filesystem::exists(file) && base::ReadFile(file) == text) return;
  base::WriteFileAtomically(file, text);
}

void RequireBoundaryMeets(const survey::Survey& survey, const std::filesystem::path& boundary) {
  const surface::MapFrame frame = FrameOf(survey, geo::Vertical::kAsTagged);
  const gis::Boundary wanted = gis::Boundary::Read(boundary, frame.georeferenced(), frame.zone());
  Eigen::AlignedBox2d flown;
  for (const survey::Photo& photo : survey.photos) flown.extend(frame.MapFromEnu(photo.cam_from_enu.OriginInSource()).head<2>());
  for (const survey::SparsePoint& point : survey.points) flown.extend(frame.MapFromEnu(point.x_in_enu).head<2>());
  const double apart_m = flown.exteriorDistance(Eigen::AlignedBox2d(wanted.min(), wanted.max()));
  if (apart_m <= 0.0) return;
  throw base::InputError(boundary, fmt::format("lies {:.0f} m beside the photos", std::max(1.0, apart_m)),
                         "Give polygons around the survey as --boundary, longitude before latitude. The poses are kept for the next try");
}

}  // namespace skyquilt::odm
