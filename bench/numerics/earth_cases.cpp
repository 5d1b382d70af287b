// One small simulated survey at many places on Earth: the same photos with other GPS tags, through the whole pipeline.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>

#include "bench/numerics/geodesy.h"
#include "bench/numerics/groups.h"
#include "bench/numerics/hamlet_flight.h"
#include "core/geo/enu_frame.h"
#include "core/survey/survey.h"

namespace skyquilt::bench {
namespace {

struct EarthPlace {
  std::string name;
  geo::Geodetic origin;
  bool fitted = true;  // also run with a frame fitted to the GPS tags
  // Near a pole, the longitude of the fitted origin (and with it the east direction) depends on the last metre, so block and grid are rotated
  // against the scene. The effect of this rotation alone is measured at home with a survey rotated by the same angle.
  bool turned = false;
  bool quick = false;
};

const std::vector<EarthPlace>& EarthPlaces() {
  static const std::vector<EarthPlace> places = {
      {.name = "at home, 47\xC2\xB0 N", .origin = {47.3769, 8.5417, 408.0}, .quick = true},
      {.name = "at the north pole", .origin = {90.0, 0.0, 2.0}, .turned = true, .quick = true},
      {.name = "at the south pole", .origin = {-90.0, 0.0, 2835.0}, .turned = true},
      {.name = "across \xC2\xB1"
               "180\xC2\xB0 on the equator",
       .origin = {0.0, 180.0, 2.0},
       .fitted = false},
      {.name = "across \xC2\xB1"
               "180\xC2\xB0 at 68.9\xC2\xB0 N",
       .origin = {68.9, -180.0, 300.0}},
      {.name = "below sea level, -430 m", .origin = {31.5, 35.5, -430.0}},
      {.name = "at 9 km height", .origin = {27.9881, 86.925, 9000.0}},
  };
  return places;
}

// The frame is that of the simulation, so that all places train on the same numbers, or it is fitted to the photos' GPS tags, as with real photos.
// With a fitted frame the places differ by rounding (near a pole also in the axes). Trainings that differ by rounding end as far apart as trainings
// with different seeds, so means over several seeds are compared.
struct EarthFrame {
  bool fitted = false;
  double turn_deg = 0.0;  // rotation of the prepared survey about the vertical
  int seeds = 1;
  int context_steps = 100, train_steps = 200;
};
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr EarthFrame kKnownFrame{};
// Chosen before any result was seen. Means of twelve runs vary half as much as means of three.
constexpr EarthFrame kFittedFrame{.fitted = true, .seeds = 12, .context_steps = 300, .train_steps = 1000};

struct EarthRun {
  std::vector<double> psnr_db;  // one per seed
  int64_t dropped_steps = 0;
  geo::Geodetic origin;
  double fit_rmse_m = kNoNumber;
  double worst_float_ecef_m = 0.0;  // largest error of camera positions in single-precision ECEF

  double MeanPsnrDb() const {
    double sum = 0.0;
    for (const double value : psnr_db) sum += value;
    return sum / static_cast<double>(psnr_db.size());
  }
};

coordinator::Settings EarthSettings(const geo::Geodetic& origin, const EarthFrame& frame, int seed, const NumericsOptions& options) {
  coordinator::Settings settings = HamletSettings({.seed = seed, .context_steps = frame.context_steps, .train_steps = frame.train_steps}, options);
  settings.simulate.latitude_deg = origin.latitude_deg;
  settings.simulate.longitude_deg = origin.longitude_deg;
  settings.simulate.height_m = origin.height_m;
  settings.Check();
  return settings;
}

// The survey with the axes of its frame rotated.
void TurnSurvey(const std::filesystem::path& folder, double turn_deg) {
  survey::Survey survey = survey::LoadSurvey(folder);
  const Eigen::Quaterniond turned_from_enu(Eigen::AngleAxisd(turn_deg * kDegree, Eigen::Vector3d::UnitZ()));
  for (survey::Photo& photo : survey.photos) photo.cam_from_enu.rotation = photo.cam_from_enu.rotation * turned_from_enu.conjugate();
  for (std::vector<survey::SparsePoint>* points : {&survey.points, &survey.kept_points}) {
    for (survey::SparsePoint& point : *points) point.x_in_enu = turned_from_enu * point.x_in_enu;
  }
  survey::SaveSurvey(survey, folder);
}

// The whole pipeline with one seed.
void FlyOnce(const EarthPlace& place, const EarthFrame& frame, int seed, const NumericsOptions& options, EarthRun* run) {
  const std::filesystem::path folder = options.work_folder / "earth";
  std::filesystem::remove_all(folder);
  coordinator::Pipeline pipeline{.comm = *options.comm,
                                 .project = coordinator::Project::Create(folder),
                                 .settings = EarthSettings(place.origin, frame, seed, options),
                                 .quiet = true};
  const std::filesystem::path photos = pipeline.project.SimulatedFolder();
  coordinator::SimulateStage(pipeline, photos);
  if (frame.fitted) {
    coordinator::PrepareStage(pipeline, photos / "images", photos / "sparse" / "0");
  } else {
    coordinator::PrepareStage(pipeline, photos, {});
  }
  if (frame.turn_deg != 0.0) TurnSurvey(pipeline.project.SurveyFolder(), frame.turn_deg);
  coordinator::PartitionStage(pipeline);
  const scene::TrainReport& training = coordinator::TrainStage(pipeline);
  coordinator::ThrowIfBlocksFailed(training, pipeline.project);
  coordinator::MergeStage(pipeline);
  run->psnr_db.push_back(coordinator::EvaluateStage(pipeline).psnr);
  for (const scene::FieldTraining& field : training.fields) run->dropped_steps += field.dropped_steps;
  const survey::Survey survey = survey::LoadSurvey(pipeline.project.SurveyFolder());
  run->origin = survey.origin;
  run->fit_rmse_m = survey.fit.rmse_m;
  const geo::EnuFrame enu(survey.origin);
  for (const survey::Photo& photo : survey.photos) {
    const geo::Geodetic camera = enu.GeodeticFromEnu(photo.cam_from_enu.OriginInSource());
    run->worst_float_ecef_m = std::max(run->worst_float_ecef_m, NaiveErrorMetres(NaiveFrame::kEcef, survey.origin, camera));
  }
  std::filesystem::remove_all(folder);
}

EarthRun FlyAt(const EarthPlace& place, const EarthFrame& frame, const NumericsOptions& options) {
  const QuietStages quiet(options.silent);
  EarthRun run;
  for (int seed = 1; seed <= frame.seeds; ++seed) FlyOnce(place, frame, seed, options, &run);
  return run;
}

// The counter-clockwise angle by which coordinates rotate from the ENU frame at `made` to the one at `found`, which is close to it. Near a pole it is
// large, because meridians converge there.
double TurnDeg(const geo::Geodetic& made, const geo::Geodetic& found) {
  return geo::WrapLongitudeDeg(made.longitude_deg - found.longitude_deg) * std::sin(found.latitude_deg * kDegree);
}

// Runs with one kind of frame; the first is at home.
using EarthRuns = std::vector<EarthRun>;

NumericCase EarthCase(const EarthPlace& place, const EarthFrame& frame, const std::shared_ptr<EarthRuns>& runs, const NumericsOptions& options) {
  constexpr double kAllowed_db = 0.1;
  const bool turned = frame.fitted && place.turned;
  return {.name = (frame.fitted ? "Frame from GPS tags, " : "Known frame, ") + place.name,
          .expected = fmt::format("finite, no step dropped, {} within {:g} dB of home{}", frame.seeds > 1 ? "mean PSNR" : "PSNR", kAllowed_db,
                                  turned ? " with axes rotated by the same angle" : ""),
          .unit = "dB",
          .limit = kAllowed_db,
          .run = [place, frame, runs, turned, options] {
            runs->push_back(FlyAt(place, frame, options));
            const EarthRun& run = runs->back();
            double wanted_db = runs->front().MeanPsnrDb();
            std::string seen = fmt::format("{:.3f} dB", run.MeanPsnrDb());
            if (frame.fitted) seen += fmt::format(" over {} seeds, fitted to the tags with {:.2f} m RMSE", frame.seeds, run.fit_rmse_m);
            if (turned) {
              EarthFrame control = frame;
              control.turn_deg = TurnDeg(place.origin, run.origin);
              const double straight_db = wanted_db;
              wanted_db = FlyAt(EarthPlaces().front(), control, options).MeanPsnrDb();
              seen += fmt::format("; home rotated by {:.2f}\xC2\xB0 {:.3f} dB, home without rotation {:.3f} dB", control.turn_deg, wanted_db,
                                  straight_db);
            }
            seen += fmt::format("; origin {:.6f}, {:.6f}, {:.1f} m", run.origin.latitude_deg, run.origin.longitude_deg, run.origin.height_m);
            return CaseResult{.seen = seen,
                              .worst = std::abs(run.MeanPsnrDb() - wanted_db),
                              .holds = run.dropped_steps == 0 && DistanceMetres(run.origin, place.origin) < 100.0};
          }};
}

}  // namespace

NumericGroup EarthGroup(const NumericsOptions& options) {
  NumericGroup group{
      .id = "earth",
      .title = "Anywhere on Earth",
      .lead =
          "The simulated hamlet at other places: the same 28 photos with other GPS tags through prepare, partition, train, merge and evaluate, "
          "with a fixed number of steps. Once in the frame of the simulation, once in a frame fitted to the noisy tags, as with real photos. Near a "
          "pole the axes of the fitted frame are rotated against the scene, which changes the grid and the block; such rows are compared with a run "
          "at home that is rotated by the same angle. Means over a fixed number of seeds are compared; the last row but one shows how much single "
          "seeds differ."};
  if (options.comm == nullptr) return group;
  const auto known = std::make_shared<EarthRuns>(), fitted = std::make_shared<EarthRuns>();
  for (const bool by_tags : {false, true}) {
    for (const EarthPlace& place : EarthPlaces()) {
      if ((by_tags && !place.fitted) || (options.quick && !place.quick)) continue;
      EarthFrame frame = by_tags ? kFittedFrame : kKnownFrame;
      if (options.quick && by_tags) {
        // One seed shows whether the way through the tags works, but is too little for a comparison with a rotated survey.
        if (place.turned) continue;
        frame.seeds = 1;
      }
      group.cases.push_back(EarthCase(place, frame, by_tags ? fitted : known, options));
    }
  }
  if (!options.quick) {
    group.cases.push_back({.name = "Instead: other random numbers",
                           .expected = "frame from GPS tags, at home: largest minus smallest PSNR over the seeds",
                           .unit = "dB",
                           .for_comparison = true,
                           .run = [fitted] {
                             const std::vector<double>& psnr_db = fitted->at(0).psnr_db;
                             const auto [low, high] = std::minmax_element(psnr_db.begin(), psnr_db.end());
                             return CaseResult{.seen = fmt::format("{:.3f} to {:.3f} dB", *low, *high), .worst = *high - *low};
                           }});
  }
  group.cases.push_back({.name = "Instead: cameras in float ECEF",
                         .expected = "how far the cameras of these surveys would move",
                         .unit = "m",
                         .for_comparison = true,
                         .run = [known] {
                           Worst worst;
                           for (const EarthRun& run : *known) worst.Take(run.worst_float_ecef_m);
                           return CaseResult{.seen = fmt::format("{:.0f} pixels of a GSD of 2 cm", worst.value() / 0.02), .worst = worst.value()};
                         }});
  return group;
}

}  // namespace skyquilt::bench
