#include "prepare/georeference/place_by_control.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "prepare/control/fit/fit_control.h"
#include "prepare/control/fit/mark_reading.h"
#include "prepare/control/reading/control_checks.h"
#include "prepare/control/reading/read_control.h"
#include "prepare/georeference/dome_fit.h"

namespace skyquilt::prepare::georeference {
namespace {

std::string Describe(const survey::ControlFit& fit, survey::ControlUse use) {
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  int n = 0, n_heights = 0;
  for (const survey::ControlPointFit& point : fit.points) {
    if (point.use != use) continue;
    ++n;
    squares.head<2>() += point.error_m.head<2>().cwiseAbs2();
    if (!std::isfinite(point.error_m.z())) continue;
    squares.z() += point.error_m.z() * point.error_m.z();
    ++n_heights;
  }
  if (n == 0) return "none";
  std::string text = fmt::format("{}, root mean square error {:.3f} m horizontally", n, std::sqrt((squares.x() + squares.y()) / n));
  if (n_heights > 0) text += fmt::format(", {:.3f} m in height", std::sqrt(squares.z() / n_heights));
  return text;
}

void LogControl(const survey::ControlFit& fit) {
  const char* how = !fit.placed ? "compared with the place from GPS tags" : fit.adjusted ? "adjusted with the photos" : "fitted by a similarity";
  base::LogInfo("{} points of {}, {}: control points: {}; check points: {}", fit.points.size(), fit.file, how,
                Describe(fit, survey::ControlUse::kControl), Describe(fit, survey::ControlUse::kCheck));
}

// Decides by the photos' poses whether marks were made in upright photos, where their file leaves that open. Logs it.
void SettleReading(const control::ControlJob& without_ties, control::ControlPoints& control) {
  const control::ReadingVotes votes = control::CountReadings(without_ties);
  if (votes.n_open == 0) return;
  const control::MarkReading reading = votes.Reading();
  if (reading == control::MarkReading::kUpright) {
    base::LogWarning(
        "{}: {} marks were made in photos shown upright, as their EXIF orientation says, and are turned to the stored photos: so {} of them agree "
        "with the other marks of their points, as they are written {}",
        control.file, votes.n_open, votes.n_upright, votes.n_stored);
  } else if (reading == control::MarkReading::kUndecided) {
    base::LogWarning(
        "{}: {} marks are in photos that are stored turned (EXIF orientation), and it is not clear whether they were made in upright photos: they "
        "are taken as written, so {} of them agree with the other marks of their points, turned {}. If control points are refused, mark the photos "
        "without turning them, or state the sizes of the marked photos in columns image_width and image_height",
        control.file, votes.n_open, votes.n_stored, votes.n_upright);
  }
  control::Settle(reading, control);
}

}  // namespace

std::vector<control::PhotoSize> PhotoSizesOf(const std::vector<input::PhotoFile>& files) {
  std::vector<control::PhotoSize> photos;
  photos.reserve(files.size());
  for (const input::PhotoFile& file : files) {
    photos.push_back({file.name, file.width, file.height, file.tags.original_width, file.tags.original_height, file.tags.orientation});
  }
  return photos;
}

control::ControlPoints ReadControlPoints(const control::ControlFiles& given, const std::vector<input::PhotoFile>& files) {
  if (given.points.empty()) return {};
  std::vector<geo::Geodetic> tags;
  for (const input::PhotoFile& file : files) {
    if (file.tags.gps) tags.push_back(*file.tags.gps);
  }
  control::ControlPoints control = control::ReadControl(given, PhotoSizesOf(files));
  for (const std::string& warning : control.warnings) base::LogWarning("{}", warning);
  control::CheckNear(control, tags);
  // Tags may turn out not to place the survey; then FitControl refuses.
  const std::string doubt = control::CheckGeometry(control, static_cast<int>(tags.size()) >= kMinAgreeing);
  if (!doubt.empty()) base::LogWarning("{}", doubt);
  return control;
}

survey::ControlFit PlaceByControl(const ControlInput& input, survey::ColmapModel& model, std::vector<input::PreparedPhoto>& photos,
                                  Georeference& georeference, base::ThreadPool& threads) {
  if (input.control.points.empty()) return {};
  const survey::ColmapObservations observations =
      input.has_observations ? survey::ReadColmapObservations(input.model_folder) : survey::ColmapObservations();
  control::ControlPoints control = input.control;
  const survey::ColmapObservations no_ties;
  SettleReading({.model = model, .observations = no_ties, .photos = photos, .control = input.control}, control);
  control::ControlJob job{.model = model, .observations = observations, .photos = photos, .control = control};
  if (georeference.ok)
    job.otherwise = control::PlaceWithoutControl{georeference.origin, georeference.enu_from_model, georeference.fit.accuracy, input.exact};
  const control::PlacedByControl placed = control::FitControl(job, threads);
  LogControl(placed.fit);
  if (placed.fit.placed) {
    for (input::PreparedPhoto& photo : photos) photo.cam_from_model = model.images[photo.image].cam_from_world;
    // Tags are compared only: problems of a place that they would have given no longer matter.
    georeference = KeepExactFrame(photos, placed.origin, input.options);
    georeference.fit.accuracy = placed.accuracy;
    georeference.fit.scale = placed.scale;
    georeference.problems = BentByControl(placed.fit);
  }
  georeference.problems.insert(georeference.problems.begin(), placed.problems.begin(), placed.problems.end());
  return placed.fit;
}

std::vector<survey::Problem> BentByControl(const survey::ControlFit& fit) {
  std::vector<HeightDifference> differences;
  double gsd_m = 0.0;
  for (const survey::ControlPointFit& point : fit.points) {
    // A control point that is used hides what it has bent.
    const double up_m = point.use == survey::ControlUse::kControl ? point.left_out_error_m.z() : point.error_m.z();
    if (point.use == survey::ControlUse::kRejected || point.use == survey::ControlUse::kUnseen || !std::isfinite(up_m)) continue;
    differences.push_back({point.given_in_enu.head<2>(), up_m});
    gsd_m += point.gsd_m;
  }
  constexpr double kSigmas = 3.0, kLeastGsds = 2.0;
  const Dome dome = FitDome(differences);
  if (!(std::abs(dome.height_m) > kSigmas * dome.sigma_m)) return {};
  if (!(std::abs(dome.height_m) > kLeastGsds * gsd_m / static_cast<double>(differences.size()))) return {};
  return {{"control_dome",
           fmt::format("Against control and check points the middle of the survey is {:.2f} m too {} (sigma {:.2f} m)", std::abs(dome.height_m),
                       dome.height_m > 0.0 ? "high" : "low", dome.sigma_m),
           "Use more control points, some of them in the middle and at the corners of the survey, or a lens calibrated beforehand and held fixed",
           false}};
}

}  // namespace skyquilt::prepare::georeference
