#include "prepare/shape_by_tags.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/geo/enu_frame.h"
#include "prepare/control_fit/adjust_to_tags.h"
#include "prepare/dome_fit.h"

namespace skyquilt::prepare {
namespace {

constexpr double kBendSigmas = 3.0;

bool Agrees(const Georeference& georeference, size_t station) {
  return georeference.inlier[station] != 0;
}

bool MostAreRtk(const std::vector<Station>& stations) {
  const auto tagged = std::count_if(stations.begin(), stations.end(), [](const Station& station) { return station.gps.has_value(); });
  const auto rtk = std::count_if(stations.begin(), stations.end(), [](const Station& station) { return station.gps.has_value() && station.rtk; });
  return 2 * rtk > tagged;
}

Dome BendOf(const std::vector<Station>& stations, const Georeference& georeference) {
  std::vector<size_t> order(stations.size());
  std::iota(order.begin(), order.end(), size_t{0});
  const auto time = [&](size_t i) { return stations[i].time_s.value_or(std::numeric_limits<double>::infinity()); };
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return time(a) < time(b); });
  std::vector<HeightDifference> differences;
  for (const size_t i : order) {
    if (!Agrees(georeference, i)) continue;
    const Eigen::Vector3d centre = georeference.enu_from_model * stations[i].cam_from_model.OriginInSource();
    differences.push_back({centre.head<2>(), georeference.residual_m[i].z()});
  }
  return FitDome(differences);
}

// Those that agree, with what the fit adds to them.
std::vector<Station> Corrected(const std::vector<Station>& stations, const Georeference& georeference) {
  const geo::EnuFrame frame(georeference.origin);
  std::vector<Station> corrected = stations;
  for (size_t i = 0; i < stations.size(); ++i) {
    std::optional<geo::Geodetic>& tag = corrected[i].gps;
    if (!Agrees(georeference, i)) tag.reset();
    if (!tag) continue;
    const bool has_height = std::isfinite(tag->height_m) && std::isfinite(georeference.residual_m[i].z());
    geo::Geodetic place = *tag;
    if (!has_height) place.height_m = georeference.origin.height_m;
    *tag = frame.GeodeticFromEnu(frame.EnuFromGeodetic(place) + georeference.correction_m[i]);
    if (!has_height) tag->height_m = std::numeric_limits<double>::quiet_NaN();
  }
  return corrected;
}

}  // namespace

bool TagsTellTheShape(const std::vector<Station>& stations, const Georeference& georeference) {
  if (!georeference.ok) return false;
  if (MostAreRtk(stations)) return true;
  const Dome bend = BendOf(stations, georeference);
  return std::abs(bend.height_m) > std::max(kLeastBend_m, kBendSigmas * bend.sigma_m);
}

void ShapeByTags(const ShapeInput& input, survey::ColmapModel& model, std::vector<Station>& stations, Georeference& georeference,
                 base::ThreadPool& threads) {
  if (!TagsTellTheShape(stations, georeference)) return;
  survey::ColmapModel adjusted = model;
  survey::ColmapObservations observations;
  try {
    observations = survey::ReadColmapObservations(input.model_folder);
  } catch (const base::InputError& error) {
    // Nothing else needs them.
    base::LogInfo("the poses are not adjusted to the GPS tags: {}", error.what());
    return;
  }
  const AdjustedToTags result = AdjustToTags({.model = adjusted,
                                              .observations = observations,
                                              .stations = Corrected(stations, georeference),
                                              .image_of_station = input.image_of_station,
                                              .origin = georeference.origin,
                                              .enu_from_model = georeference.enu_from_model},
                                             threads);
  if (!result.adjusted) {
    base::LogInfo("the poses are not adjusted to the GPS tags: {}", result.reason);
    return;
  }
  std::vector<Station> new_stations = stations;
  for (size_t i = 0; i < stations.size(); ++i) new_stations[i].cam_from_model = adjusted.images[input.image_of_station[i]].cam_from_world;
  std::vector<Eigen::Vector3d> points;
  points.reserve(adjusted.points.size());
  for (const survey::ColmapPoint& point : adjusted.points) points.push_back(point.x_in_world);
  Georeference placed = PlaceOnEarth(new_stations, points, input.options);
  const Dome before = BendOf(stations, georeference);
  const Dome after = placed.ok ? BendOf(new_stations, placed) : Dome();
  if (!placed.ok || placed.fit.n_inliers < georeference.fit.n_inliers ||
      std::abs(after.height_m) > std::abs(before.height_m) + kBendSigmas * after.sigma_m) {
    base::LogInfo("the poses are not adjusted to the GPS tags: fewer tags would agree, or the bend would be larger");
    return;
  }
  // The adjustment has made metres of the model's units.
  placed.fit.scale *= georeference.fit.scale;
  placed.fit.adjusted_to_tags = true;
  base::LogInfo(
      "poses adjusted to the GPS tags: middle above edge against the tags {:+.2f} m, before {:+.2f} m; median error of features {:.2f} px, "
      "before {:.2f} px, at 1600 px",
      after.height_m, before.height_m, result.error_after, result.error_before);
  // In place: others point to the images.
  std::copy(adjusted.images.begin(), adjusted.images.end(), model.images.begin());
  model.cameras = std::move(adjusted.cameras);
  model.points = std::move(adjusted.points);
  stations = std::move(new_stations);
  georeference = std::move(placed);
}

}  // namespace skyquilt::prepare
