#include "viewer/data/survey_place.h"

#include "core/geo/ecef.h"

namespace skyquilt::viewer {

std::optional<geo::Rigid3d> OtherFromMain(const SurveyPlace& main, const SurveyPlace& other) {
  if (main.georeferenced != other.georeferenced) return {};
  if (!main.georeferenced) return geo::Rigid3d();
  if (!geo::IsValid(main.origin) || !geo::IsValid(other.origin)) return {};
  const Eigen::Matrix4d ecef_from_main = geo::EcefFromEnu(main.origin), ecef_from_other = geo::EcefFromEnu(other.origin);
  const Eigen::Matrix3d other_from_ecef = ecef_from_other.topLeftCorner<3, 3>().transpose();
  geo::Rigid3d other_from_main;
  other_from_main.rotation = Eigen::Quaterniond(Eigen::Matrix3d(other_from_ecef * ecef_from_main.topLeftCorner<3, 3>())).normalized();
  // The difference first: it is small, and loses no digits to the Earth's radius.
  other_from_main.translation = other_from_ecef * (ecef_from_main.topRightCorner<3, 1>() - ecef_from_other.topRightCorner<3, 1>());
  return other_from_main;
}

}  // namespace skyquilt::viewer
