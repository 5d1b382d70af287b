#include "prepare/control/reading/control_checks.h"

#include <fmt/core.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "core/base/errors.h"
#include "core/geo/crs.h"
#include "core/geo/ecef.h"
#include "core/geo/utm.h"
#include "core/linear/linear.h"
#include "prepare/tables/text_table.h"

namespace skyquilt::prepare::control {
namespace {

constexpr double kFar_m = 100e3;
constexpr double kLineRatio = 0.01;
constexpr size_t kNeeded = 3;
constexpr double kFeetPerMetre = 3937.0 / 1200.0;  // US survey feet; the international foot differs by 2 in a million

// Without their heights, which may be unknown.
Eigen::Vector3d OnEllipsoid(const geo::Geodetic& place) {
  return geo::EcefFromGeodetic({place.latitude_deg, place.longitude_deg, 0.0});
}

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Medians of Earth-centred coordinates have no seam at the date line.
std::optional<geo::Geodetic> MiddleOf(const std::vector<geo::Geodetic>& tags) {
  std::vector<double> x, y, z;
  for (const geo::Geodetic& tag : tags) {
    if (!geo::IsValid({tag.latitude_deg, tag.longitude_deg, 0.0})) continue;
    const Eigen::Vector3d position = OnEllipsoid(tag);
    x.push_back(position.x());
    y.push_back(position.y());
    z.push_back(position.z());
  }
  if (x.empty()) return std::nullopt;
  return geo::GeodeticFromEcef({Median(x), Median(y), Median(z)});
}

double Distance_m(const geo::Geodetic& a, const geo::Geodetic& b) {
  return (OnEllipsoid(a) - OnEllipsoid(b)).norm();
}

// Tries what people mistake most often.
class Mistakes {
 public:
  Mistakes(const Eigen::Vector2d& given, const std::string& definition, const geo::Geodetic& photos) : given_(given), photos_(photos) {
    try {
      crs_.emplace(definition);
      if (crs_->heights() != geo::CrsHeights::kNone) crs_.emplace(crs_->WithoutHeights());
    } catch (const std::invalid_argument&) {
      crs_.reset();
    }
  }

  // How to fix it; empty: none of them.
  std::string Advice() const {
    const Eigen::Vector2d swapped(given_.y(), given_.x());
    if (Fits(swapped)) return "With x and y exchanged it lies near the photos: say so with prepare.gcp_columns, for instance label,north,east,up";
    if (!crs_ || !crs_->IsGeographic()) {
      for (const Eigen::Vector2d& xy : {given_, swapped}) {
        if (const std::string zone = FittingZone(xy); !zone.empty()) {
          return "In " + zone + (xy == given_ ? "" : " with x and y exchanged") + " it lies near the photos: give that with prepare.gcp_crs";
        }
      }
      if (Fits(given_ * kFeetPerMetre)) return "Taken as metres it lies near the photos: give a coordinate system in metres with prepare.gcp_crs";
      if (Fits(given_ / kFeetPerMetre)) return "Taken as feet it lies near the photos: give a coordinate system in feet with prepare.gcp_crs";
    } else {
      for (const Eigen::Vector2d& sign : {Eigen::Vector2d(-1.0, 1.0), Eigen::Vector2d(1.0, -1.0), Eigen::Vector2d(-1.0, -1.0)}) {
        if (Fits(given_.cwiseProduct(sign)))
          return "With the other sign of its longitude or latitude it lies near the photos: west and south are negative";
      }
    }
    return "Check its coordinates, and that prepare.gcp_crs is their system";
  }

 private:
  bool IsNear(const geo::Geodetic& place) const { return Distance_m(place, photos_) < kFar_m; }
  bool Fits(const Eigen::Vector2d& xy) const {
    if (!crs_) return false;
    try {
      return IsNear(crs_->ToGeodetic({xy.x(), xy.y(), 0.0}));
    } catch (const std::invalid_argument&) {
      return false;
    }
  }
  // Name and code of a UTM zone around the photos, in either hemisphere.
  std::string FittingZone(const Eigen::Vector2d& xy) const {
    const geo::UtmZone here = geo::UtmZoneOf(photos_);
    if (here.zone == 0) return "";
    for (const bool north : {here.north, !here.north}) {
      for (const int step : {0, -1, 1}) {
        const geo::UtmZone zone{(here.zone + step + 59) % 60 + 1, north};
        const geo::Geodetic place = geo::GeodeticFromUtm(xy, 0.0, zone);
        if (geo::IsValid(place) && IsNear(place)) return zone.Name() + " (EPSG:" + std::to_string(zone.Epsg()) + ")";
      }
    }
    return "";
  }

  Eigen::Vector2d given_;
  geo::Geodetic photos_;
  std::optional<geo::Crs> crs_;
};

// Standard deviations along the principal directions, largest first.
Eigen::Vector3d Spread(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Matrix3Xd all(3, static_cast<Eigen::Index>(points.size()));
  for (size_t i = 0; i < points.size(); ++i) all.col(static_cast<Eigen::Index>(i)) = points[i];
  const Eigen::Matrix3Xd centred = all.colwise() - all.rowwise().mean();
  const Eigen::Matrix3d products = centred * centred.transpose() / static_cast<double>(points.size());
  return linear::SymmetricEigen(products).values.cwiseMax(0.0).cwiseSqrt().reverse();
}

// Why they cannot place a survey; empty: they can.
std::string GeometryProblem(const ControlPoints& control) {
  std::vector<Eigen::Vector3d> places;
  size_t n_control = 0;
  size_t n_heights = 0;
  double height = 0.0;
  for (const ControlPoint& point : control.points) {
    if (point.check) continue;
    ++n_control;
    if (point.marks.size() < 2) continue;
    // A missing height is taken from the point before.
    if (std::isfinite(point.place.height_m)) {
      height = point.place.height_m;
      ++n_heights;
    }
    places.push_back(geo::EcefFromGeodetic({point.place.latitude_deg, point.place.longitude_deg, height}));
  }
  if (places.size() < kNeeded) {
    return fmt::format("only {} of {} control points are marked in two photos or more, {} are needed", places.size(), n_control, kNeeded);
  }
  if (n_heights < kNeeded) return fmt::format("only {} of {} usable control points have a height, {} are needed", n_heights, places.size(), kNeeded);
  const Eigen::Vector3d spread = Spread(places);
  if (!(spread[1] > kLineRatio * spread[0])) return "all usable control points lie on one line, so the survey could turn about it";
  return "";
}

}  // namespace

void CheckNear(const ControlPoints& points, const std::vector<geo::Geodetic>& tags) {
  const std::optional<geo::Geodetic> middle = MiddleOf(tags);
  if (!middle) return;
  for (const ControlPoint& point : points.points) {
    const double distance_m = Distance_m(point.place, *middle);
    if (distance_m <= kFar_m) continue;
    tables::FailTableLine(points.file, point.line,
                          fmt::format("{} in {} is {:.0f} km from the photos, by their GPS tags", point.label, points.crs, 1e-3 * distance_m),
                          Mistakes(point.given.head<2>(), points.crs_definition, *middle).Advice());
  }
}

std::string CheckGeometry(const ControlPoints& points, bool have_place) {
  const std::string problem = GeometryProblem(points);
  if (problem.empty()) return "";
  if (!have_place) {
    throw base::InputError(
        points.file, problem,
        "Mark three control points or more that are spread over the area, or name fewer of them as check points; photos with GPS tags "
        "can be placed without");
  }
  return points.file + ": " + problem + "; the place comes from the photos' GPS tags, and the points are only compared with it";
}

}  // namespace skyquilt::prepare::control
