#include "prepare/georeference/shape_by_tags.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/geo/enu_frame.h"
#include "prepare/control/fit/adjust_to_tags.h"
#include "prepare/georeference/dome_fit.h"
#include "prepare/georeference/filter_sparse_points.h"
#include "prepare/poses/focal_check.h"
#include "prepare/poses/seed/take_off_height.h"

namespace skyquilt::prepare::georeference {
namespace {

constexpr double kBendSigmas = 3.0;

bool MostAreRtk(const std::vector<input::PreparedPhoto>& photos) {
  const auto tagged = std::count_if(photos.begin(), photos.end(), [](const input::PreparedPhoto& photo) { return photo.gps.has_value(); });
  const auto rtk = std::count_if(photos.begin(), photos.end(), [](const input::PreparedPhoto& photo) { return photo.gps.has_value() && photo.rtk; });
  return 2 * rtk > tagged;
}

Dome BendOf(const std::vector<input::PreparedPhoto>& photos, const Georeference& georeference) {
  std::vector<size_t> order(photos.size());
  std::iota(order.begin(), order.end(), size_t{0});
  const auto time = [&](size_t i) { return photos[i].file.tags.capture_time_s.value_or(std::numeric_limits<double>::infinity()); };
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return time(a) < time(b); });
  std::vector<HeightDifference> differences;
  for (const size_t i : order) {
    if (!georeference.photos[i].inlier) continue;
    const Eigen::Vector3d centre = georeference.enu_from_model * photos[i].cam_from_model.OriginInSource();
    differences.push_back({centre.head<2>(), georeference.photos[i].residual_m.z()});
  }
  return FitDome(differences);
}

// Those that agree, with what the fit adds to them.
std::vector<input::PreparedPhoto> Corrected(const std::vector<input::PreparedPhoto>& photos, const Georeference& georeference) {
  const geo::EnuFrame frame(georeference.origin);
  std::vector<input::PreparedPhoto> corrected = photos;
  for (size_t i = 0; i < photos.size(); ++i) {
    std::optional<geo::Geodetic>& tag = corrected[i].gps;
    const TagFit& fit = georeference.photos[i];
    if (!fit.inlier) tag.reset();
    if (!tag) continue;
    const bool has_height = std::isfinite(tag->height_m) && std::isfinite(fit.residual_m.z());
    geo::Geodetic place = *tag;
    if (!has_height) place.height_m = georeference.origin.height_m;
    *tag = frame.GeodeticFromEnu(frame.EnuFromGeodetic(place) + fit.correction_m);
    if (!has_height) tag->height_m = std::numeric_limits<double>::quiet_NaN();
  }
  return corrected;
}

struct ShapeStart {
  const ShapeInput& input;
  const survey::ColmapModel& model;
  const survey::ColmapObservations& observations;
  const std::vector<input::PreparedPhoto>& photos;
  const Georeference& georeference;
};

// The model after an adjustment to the tags, placed on Earth.
struct Shaped {
  survey::ColmapModel model;
  std::vector<input::PreparedPhoto> photos;
  Georeference georeference;
  double error_before = 0.0, error_after = 0.0;
};

// Nothing when there is no adjustment; the log says why.
std::optional<Shaped> AdjustShape(const ShapeStart& start, bool hold_focal, base::ThreadPool& threads) {
  Shaped shaped{.model = start.model, .photos = start.photos, .georeference = {}};
  const control::AdjustedToTags result = control::AdjustToTags({.model = shaped.model,
                                                                .observations = start.observations,
                                                                .photos = Corrected(start.photos, start.georeference),
                                                                .origin = start.georeference.origin,
                                                                .enu_from_model = start.georeference.enu_from_model,
                                                                .hold_focal = hold_focal},
                                                               threads);
  if (!result.adjusted) {
    base::LogInfo("the poses are not adjusted to the GPS tags: {}", result.reason);
    return std::nullopt;
  }
  for (input::PreparedPhoto& photo : shaped.photos) photo.cam_from_model = shaped.model.images[photo.image].cam_from_world;
  std::vector<Eigen::Vector3d> points;
  points.reserve(shaped.model.points.size());
  for (const survey::ColmapPoint& point : shaped.model.points) points.push_back(point.x_in_world);
  PlaceOptions options = start.input.options;
  if (options.up) options.up = start.georeference.enu_from_model.rotation * *options.up;
  shaped.georeference = PlaceOnEarth(shaped.photos, points, options);
  shaped.error_before = result.error_before;
  shaped.error_after = result.error_after;
  return shaped;
}

bool HasHeightTags(const std::vector<input::PreparedPhoto>& photos) {
  return std::any_of(photos.begin(), photos.end(), [](const input::PreparedPhoto& photo) { return photo.file.tags.relative_altitude_m.has_value(); });
}

poses::HeightAboveTakeOff HeightsOf(const survey::ColmapModel& model, const std::vector<input::PreparedPhoto>& photos,
                                    const geo::Similarity3d& enu_from_model, base::ThreadPool& threads) {
  survey::Survey survey;
  for (const input::PreparedPhoto& prepared : photos) {
    survey::Photo& photo = survey.photos.emplace_back();
    photo.cam_from_enu = geo::TransformCameraWorld(prepared.cam_from_model, enu_from_model);
    photo.relative_altitude_m = prepared.file.tags.relative_altitude_m;
  }
  survey.points.reserve(model.points.size());
  for (const survey::ColmapPoint& point : model.points) survey.points.emplace_back().x_in_enu = enu_from_model * point.x_in_world;
  MeasureAgl(survey, threads);
  std::vector<double> found, tagged;
  for (const survey::Photo& photo : survey.photos) {
    found.push_back(photo.agl_m);
    tagged.push_back(photo.relative_altitude_m.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
  return poses::CompareHeights(found, tagged);
}

// Whether the adjustment changes a focal length by much: one that only passes a limit is as good as before.
bool FocalDriven(const survey::ColmapModel& before, const survey::ColmapModel& after) {
  std::map<uint32_t, double> from_px;
  for (const auto& [id, camera] : before.cameras) from_px.emplace(id, camera.FocalX());
  return poses::AnyFocalMoved(from_px, after);
}

// The focal length, or where tags do not say it the height above ground, when it was near the tags before the adjustment and is far from them
// afterwards, in words; else empty.
std::string LostFocal(const ShapeStart& start, const Shaped& shaped, base::ThreadPool& threads) {
  const std::map<uint32_t, double>& tagged_px = start.input.tagged_focal_px;
  if (!tagged_px.empty()) {
    if (!FocalDriven(start.model, shaped.model)) return "";
    const std::optional<poses::FarFocal> far = poses::FindFocalFarFrom(tagged_px, shaped.model);
    return far && !poses::FindFocalFarFrom(tagged_px, start.model) ? far->Text() : "";
  }
  if (!shaped.georeference.ok || !HasHeightTags(start.photos) || !FocalDriven(start.model, shaped.model)) return "";
  const poses::HeightAboveTakeOff after = HeightsOf(shaped.model, shaped.photos, shaped.georeference.enu_from_model, threads);
  if (!after.Differs()) return "";
  const poses::HeightAboveTakeOff before = HeightsOf(start.model, start.photos, start.georeference.enu_from_model, threads);
  if (before.Differs()) return "";
  return fmt::format("a height above ground of {:.0f} m, where RelativeAltitude says {:.0f} m", after.found_m, after.tagged_m);
}

}  // namespace

bool TagsTellTheShape(const std::vector<input::PreparedPhoto>& photos, const Georeference& georeference) {
  if (!georeference.ok) return false;
  if (MostAreRtk(photos)) return true;
  const Dome bend = BendOf(photos, georeference);
  return std::abs(bend.height_m) > std::max(kLeastBend_m, kBendSigmas * bend.sigma_m);
}

void ShapeByTags(const ShapeInput& input, survey::ColmapModel& model, std::vector<input::PreparedPhoto>& photos, Georeference& georeference,
                 base::ThreadPool& threads) {
  if (!TagsTellTheShape(photos, georeference)) return;
  survey::ColmapObservations observations;
  try {
    observations = survey::ReadColmapObservations(input.model_folder);
  } catch (const base::InputError& error) {
    // Nothing else needs them.
    base::LogInfo("the poses are not adjusted to the GPS tags: {}", error.what());
    return;
  }
  const ShapeStart start{input, model, observations, photos, georeference};
  std::optional<Shaped> shaped = AdjustShape(start, false, threads);
  if (!shaped) return;
  std::string lost = LostFocal(start, *shaped, threads);
  if (!lost.empty()) {
    base::LogInfo("adjusting the poses to the GPS tags gives {}; once more with the focal length held", lost);
    shaped = AdjustShape(start, true, threads);
    if (!shaped) return;
    lost = LostFocal(start, *shaped, threads);
    if (!lost.empty()) {
      base::LogInfo("the poses are not adjusted to the GPS tags: that would give {}", lost);
      return;
    }
  }
  Georeference& placed = shaped->georeference;
  const Dome before = BendOf(photos, georeference);
  const Dome after = placed.ok ? BendOf(shaped->photos, placed) : Dome();
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
      after.height_m, before.height_m, shaped->error_after, shaped->error_before);
  model = std::move(shaped->model);
  photos = std::move(shaped->photos);
  georeference = std::move(placed);
}

}  // namespace skyquilt::prepare::georeference
