#include "prepare/holdout_poses.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/geo/enu_frame.h"
#include "prepare/bundle/resect.h"
#include "prepare/bundle/shots.h"
#include "prepare/control/fit/control_adjustment.h"
#include "prepare/control/fit/control_bundle.h"
#include "prepare/control/fit/fit_control.h"
#include "prepare/control/fit/update_model.h"
#include "prepare/control/reading/control_points.h"
#include "prepare/poses/focal_check.h"
#include "prepare/poses/loose_photos.h"

namespace skyquilt::prepare {
namespace {

// Photos that look straight down hardly determine the focal length. What the search for poses found, by tags too, must not be lost here.
constexpr double kFocalSigma = 0.01;  // relative

control::ControlBundle BundleWithoutControl(survey::ColmapModel& model, const survey::ColmapObservations& observations) {
  const std::vector<input::PreparedPhoto> no_marked;
  const control::ControlPoints no_points;
  return control::MakeControlBundle({.model = model, .observations = observations, .photos = no_marked, .control = no_points});
}

// Where photos are holds the frame of an adjustment without tags, so loosely (the size of the survey) that it bends nothing.
void HoldFrame(bundle::BundleProblem& bundle) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const bundle::BundlePhoto& photo : bundle.photos) middle += photo.centre / static_cast<double>(bundle.photos.size());
  double size = 0.0;
  for (const bundle::BundlePhoto& photo : bundle.photos) size = std::max(size, (photo.centre - middle).norm());
  if (!(size > 0.0)) return;
  for (bundle::BundlePhoto& photo : bundle.photos) {
    photo.gps = photo.centre;
    photo.gps_sigma = Eigen::Vector3d::Constant(size);
  }
}

// How many photos only the removed ones tie to the rest.
size_t CountNewlyLoose(const survey::ColmapModel& before, const survey::ColmapModel& after) {
  const std::vector<std::string> were_loose = poses::LoosePhotos(before), are_loose = poses::LoosePhotos(after);
  std::vector<std::string> newly;
  std::set_difference(are_loose.begin(), are_loose.end(), were_loose.begin(), were_loose.end(), std::back_inserter(newly));
  return newly.size();
}

// Why the model cannot be adjusted without the others; empty: it can.
std::string WhyNot(const survey::ColmapModel& given, const survey::ColmapModel& rest, const control::ControlBundle& tied) {
  if (!tied.known_lenses) return "the camera model has coefficients that the adjustment does not know";
  if (tied.n_ties < control::kLeastTies) {
    return fmt::format("the model has {} points with observations in two of the other photos, {} are needed", tied.n_ties, control::kLeastTies);
  }
  const size_t loose = CountNewlyLoose(given, rest);
  return loose > 0 ? fmt::format("without them, {} of the other photos have nearly no points in common with the rest", loose) : "";
}

// By the order of names where times are not known.
size_t NearestInTime(const std::vector<input::PreparedPhoto>& photos, size_t photo, const std::vector<size_t>& among) {
  const auto distance = [&](size_t i) {
    const double in_list = std::abs(static_cast<double>(i) - static_cast<double>(photo));
    const bool timed = photos[photo].file.tags.capture_time_s && photos[i].file.tags.capture_time_s;
    return std::pair(
        timed ? std::abs(*photos[i].file.tags.capture_time_s - *photos[photo].file.tags.capture_time_s) : std::numeric_limits<double>::infinity(),
        in_list);
  };
  return *std::min_element(among.begin(), among.end(), [&](size_t a, size_t b) { return distance(a) < distance(b); });
}

// The camera less its tag, corrected as another one's.
Eigen::Vector3d ResidualAs(const input::PreparedPhoto& photo, const georeference::TagFit& other, const georeference::Georeference& georeference) {
  const geo::EnuFrame frame(georeference.origin);
  geo::Geodetic tag = *photo.gps;
  const bool has_height = std::isfinite(tag.height_m) && std::isfinite(other.residual_m.z());
  if (!has_height) tag.height_m = georeference.origin.height_m;
  Eigen::Vector3d residual = georeference.enu_from_model * photo.cam_from_model.OriginInSource() - frame.EnuFromGeodetic(tag);
  residual -= other.correction_m;
  if (!has_height) residual.z() = std::numeric_limits<double>::quiet_NaN();
  return residual;
}

}  // namespace

std::optional<WithheldPhotos> WithholdPhotos(const std::unordered_set<uint32_t>& withheld, survey::ColmapObservations observations,
                                             survey::ColmapModel& model, base::ThreadPool& threads, std::string* reason) {
  const auto is_withheld = [&](const survey::ColmapImage& image) { return withheld.contains(image.id); };
  survey::ColmapModel rest = model;
  poses::RemovePhotos(is_withheld, rest);
  control::ControlBundle tied = BundleWithoutControl(rest, observations);
  *reason = WhyNot(model, rest, tied);
  if (!reason->empty()) return std::nullopt;
  HoldFrame(tied.bundle);
  for (bundle::BundleLens& lens : tied.bundle.lenses) lens.focal_sigma = kFocalSigma;
  const std::vector<bundle::BundlePhoto> before = tied.bundle.photos;
  base::Progress progress("adjust without held-out photos", control::kUsualIterations, "iterations");
  const bool adjusted = control::AdjustToFeatures(tied, threads, [&] { progress.Advance(); });
  progress.Finish();
  if (!adjusted) {
    *reason = "the adjustment without them found no solution";
    return std::nullopt;
  }
  control::UpdateModel(tied, {}, before, true, rest);
  if (const auto far = poses::FindFarFocal(rest, model.cameras)) {
    *reason = fmt::format("without them, the adjustment makes a focal length of {:.0f} px out of {:.0f} px", far->found_px, far->tagged_px);
    return std::nullopt;
  }
  std::vector<survey::ColmapPoint> placed;
  for (size_t t = 0; t < tied.n_ties; ++t) {
    if (tied.bundle.has_point[t] != 0) placed.push_back(std::move(rest.points[tied.point_of_tie[t]]));
  }
  rest.points = std::move(placed);
  WithheldPhotos photos{.images = {}, .observations = std::move(observations), .tie_sigma = tied.tie_sigma};
  std::copy_if(model.images.begin(), model.images.end(), std::back_inserter(photos.images), is_withheld);
  base::LogInfo(
      "{} held-out photos taken out of the model, {} others adjusted to their own features (sigma {:.2f} px at 1600 px); {} of {} points stay",
      photos.images.size(), rest.images.size(), photos.tie_sigma, rest.points.size(), model.points.size());
  model = std::move(rest);
  return photos;
}

std::vector<std::string> ResectWithheld(const WithheldPhotos& photos, survey::ColmapModel& model) {
  // Features of photos that did not help to place the points fit them a little less well.
  constexpr double kLeastThreshold = 1.5;  // pixels of a photo of 1600 pixels width
  const size_t first = model.images.size();
  model.images.insert(model.images.end(), photos.images.begin(), photos.images.end());
  control::ControlBundle tied = BundleWithoutControl(model, photos.observations);
  tied.SetAccuracy(photos.tie_sigma, tied.mark_sigma_px);
  const double threshold = std::max(control::kTieThreshold, kLeastThreshold / photos.tie_sigma);
  bundle::BundleProblem& bundle = tied.bundle;
  for (size_t i = first; i < bundle.photos.size(); ++i) bundle.photos[i].placed = false;
  bundle::ResectPhotos(bundle, threshold);

  const std::vector<std::vector<uint32_t>> entries = bundle::EntriesOfPhotos(bundle);
  const std::vector<uint32_t> track_of = bundle::TrackOfEntries(bundle.tracks);
  for (size_t i = first; i < bundle.photos.size(); ++i) {
    bundle::BundlePhoto& photo = bundle.photos[i];
    photo.placed =
        photo.placed && bundle::RefineByPoints(bundle, static_cast<uint32_t>(i), entries[i], track_of, threshold) >= bundle::kLeastObservations;
  }
  bundle::PlaceShots(bundle);
  std::vector<survey::ColmapImage> resected;
  std::vector<std::string> lost;
  for (size_t i = first; i < bundle.photos.size(); ++i) {
    survey::ColmapImage& image = model.images[i];
    const bundle::BundlePhoto& photo = bundle.photos[i];
    if (!photo.placed) {
      lost.push_back(image.name);
      continue;
    }
    image.cam_from_world = {photo.cam_from_enu, -(photo.cam_from_enu * photo.centre)};
    for (const uint32_t e : entries[i]) {
      if (bundle.agrees[e] != 0) model.points[tied.point_of_tie[track_of[e]]].image_ids.push_back(image.id);
    }
    resected.push_back(std::move(image));
  }
  model.images.resize(first);
  model.images.insert(model.images.end(), resected.begin(), resected.end());
  base::LogInfo("{} of {} held-out photos placed by the points of the others", resected.size(), photos.images.size());
  return lost;
}

void AddResected(const std::vector<input::PreparedPhoto>& photos, const std::set<std::string>& resected, georeference::Georeference& georeference) {
  std::vector<georeference::TagFit> all(photos.size());
  std::vector<size_t> others, tagged;
  for (size_t i = 0; i < photos.size(); ++i) {
    if (resected.contains(photos[i].file.name)) continue;
    SKYQUILT_CHECK(others.size() < georeference.photos.size(), "one entry per photo with a part in the geo-reference");
    all[i] = georeference.photos[others.size()];
    others.push_back(i);
    if (photos[i].gps) tagged.push_back(i);
  }
  for (size_t i = 0; i < photos.size(); ++i) {
    if (!resected.contains(photos[i].file.name)) continue;
    all[i].flight = all[NearestInTime(photos, i, others)].flight;
    if (!georeference.ok || !photos[i].gps || tagged.empty()) continue;
    const georeference::TagFit& like = all[NearestInTime(photos, i, tagged)];
    all[i].correction_m = like.correction_m;
    all[i].residual_m = ResidualAs(photos[i], like, georeference);
  }
  georeference.photos = std::move(all);
}

}  // namespace skyquilt::prepare
