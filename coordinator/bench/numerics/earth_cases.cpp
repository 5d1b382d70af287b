// One small survey, flown at many places of the Earth: the same photos with other tags, through the whole pipeline.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "coordinator/bench/numerics/geodesy.h"
#include "coordinator/bench/numerics/groups.h"
#include "coordinator/bench/numerics/quiet_stages.h"
#include "coordinator/pipeline.h"
#include "core/base/file.h"
#include "core/geo/enu_frame.h"
#include "core/survey/survey.h"

namespace skyquilt::coordinator::numerics {
namespace {

struct EarthPlace {
  std::string name;
  geo::Geodetic origin;
};

const std::vector<EarthPlace>& EarthPlaces() {
  static const std::vector<EarthPlace> places = {
      {"at home, 47\xC2\xB0 N", {47.3769, 8.5417, 408.0}},
      {"at the north pole", {90.0, 0.0, 2.0}},
      {"at the south pole", {-90.0, 0.0, 2835.0}},
      {"across \xC2\xB1"
       "180\xC2\xB0 on the equator",
       {0.0, 180.0, 2.0}},
      {"across \xC2\xB1"
       "180\xC2\xB0 at 68.9\xC2\xB0 N",
       {68.9, -180.0, 300.0}},
      {"below sea level, -430 m", {31.5, 35.5, -430.0}},
      {"at 9 km height", {27.9881, 86.925, 9000.0}},
  };
  return places;
}

struct EarthRun {
  double psnr_db = kNoNumber;
  int64_t dropped_steps = 0;
  geo::Geodetic origin;
  double fit_rmse_m = kNoNumber;
  double worst_float_ecef_m = 0.0;  // of the cameras' positions
};

Settings EarthSettings(const geo::Geodetic& origin, int seed, const NumericsOptions& options) {
  Settings settings;
  settings.run.seed = seed;
  settings.simulate.preset = "hamlet";
  settings.simulate.latitude_deg = origin.latitude_deg;
  settings.simulate.longitude_deg = origin.longitude_deg;
  settings.simulate.height_m = origin.height_m;
  settings.simulate.samples_per_pixel = 1;
  settings.simulate.soft_shadows = false;
  settings.run.threads = options.threads;
  settings.partition.blocks = "1x1";
  settings.context.steps = options.quick ? 150 : 300;
  settings.train.steps = options.quick ? 300 : 1000;
  settings.context.batch_samples = settings.train.batch_samples = 8192;
  settings.Validate();
  return settings;
}

// fitted: the frame is found from the photos' GPS tags, as with real photos; else the simulation's own is taken over.
EarthRun FlyAt(const EarthPlace& place, bool fitted, int seed, const NumericsOptions& options) {
  const QuietStages quiet(options.silent);
  const std::filesystem::path folder = options.work_folder / "earth";
  std::filesystem::remove_all(folder);
  Pipeline pipeline{.comm = *options.comm, .project = Project::Create(folder), .settings = EarthSettings(place.origin, seed, options), .quiet = true};
  const std::filesystem::path photos = pipeline.project.SimulatedFolder();
  SimulateStage(pipeline, photos);
  if (fitted) {
    PrepareStage(pipeline, photos / "images", photos / "sparse" / "0");
  } else {
    PrepareStage(pipeline, photos, {});
  }
  PartitionStage(pipeline);
  ThrowIfBlocksFailed(TrainStage(pipeline), pipeline.project);
  MergeStage(pipeline);
  EvaluateStage(pipeline);
  EarthRun run;
  const nlohmann::json metrics = nlohmann::json::parse(base::ReadFile(pipeline.project.ReportFolder() / "metrics.json"));
  if (metrics.at("psnr").is_number()) run.psnr_db = metrics.at("psnr").get<double>();
  const nlohmann::json training = nlohmann::json::parse(base::ReadFile(pipeline.project.TrainReport()));
  for (const nlohmann::json& field : training.at("fields")) run.dropped_steps += field.at("dropped_steps").get<int64_t>();
  const survey::Survey survey = survey::LoadSurvey(pipeline.project.SurveyFolder());
  run.origin = survey.origin;
  run.fit_rmse_m = survey.fit.rmse_m;
  const geo::EnuFrame frame(survey.origin);
  for (const survey::Photo& photo : survey.photos) {
    const geo::Geodetic camera = frame.GeodeticFromEnu(photo.cam_from_enu.OriginInSource());
    run.worst_float_ecef_m = std::max(run.worst_float_ecef_m, NaiveError_m(NaiveFrame::kEcef, survey.origin, camera));
  }
  std::filesystem::remove_all(folder);
  return run;
}

// Runs of one kind; the first is at home.
struct EarthRuns {
  std::vector<EarthRun> runs;
  double home_db() const { return runs.empty() ? kNoNumber : runs.front().psnr_db; }
};

NumericCase EarthCase(const EarthPlace& place, bool fitted, double limit_db, const std::shared_ptr<EarthRuns>& runs, const NumericsOptions& options) {
  return {.name = std::string(fitted ? "Frame from GPS tags, " : "Known frame, ") + place.name,
          .expected = fmt::format("finite, no step dropped, PSNR within {:g} dB of home", limit_db),
          .unit = "dB",
          .limit = limit_db,
          .run = [place, fitted, runs, options] {
            runs->runs.push_back(FlyAt(place, fitted, 1, options));
            const EarthRun& run = runs->runs.back();
            const double off_m = Distance_m(run.origin, place.origin);
            return Finding{
                .seen = fmt::format("{:.3f} dB, origin at {:.6f}, {:.6f}, {:.1f} m{}", run.psnr_db, run.origin.latitude_deg, run.origin.longitude_deg,
                                    run.origin.height_m, fitted ? fmt::format(", fitted to the tags with {:.2f} m RMSE", run.fit_rmse_m) : ""),
                .worst = std::abs(run.psnr_db - runs->home_db()),
                .holds = run.dropped_steps == 0 && off_m < 100.0};
          }};
}

}  // namespace

NumericGroup EarthGroup(const NumericsOptions& options) {
  NumericGroup group{
      .id = "earth",
      .title = "Anywhere on Earth",
      .lead =
          "The simulated hamlet flown at other places: the same 28 photos with other GPS tags through prepare, partition, train, merge and "
          "evaluate, with a fixed number of steps. Once in the simulation's own frame, once in a frame found from the noisy tags, as with "
          "real photos."};
  if (options.comm == nullptr) return group;
  const auto known = std::make_shared<EarthRuns>(), fitted = std::make_shared<EarthRuns>();
  for (const bool by_tags : {false, true}) {
    for (size_t i = 0; i < EarthPlaces().size(); ++i) {
      // Quick: home, a pole and the date line.
      if (options.quick && i != 0 && i != 1 && i != 4) continue;
      if (options.quick && by_tags && i == 4) continue;
      group.cases.push_back(EarthCase(EarthPlaces()[i], by_tags, 0.1, by_tags ? fitted : known, options));
    }
  }
  group.cases.push_back({.name = "Instead: at home with other random numbers",
                         .expected = "frame from GPS tags; what chance alone changes in so short a training",
                         .unit = "dB",
                         .for_comparison = true,
                         .run = [fitted, options] {
                           Worst worst;
                           Finding finding;
                           for (const int seed : {2, 3}) {
                             const EarthRun run = FlyAt(EarthPlaces()[0], true, seed, options);
                             worst.Take(std::abs(run.psnr_db - fitted->home_db()));
                             finding.seen += fmt::format("{}{:.3f} dB", finding.seen.empty() ? "" : ", ", run.psnr_db);
                             if (options.quick) break;
                           }
                           finding.worst = worst.value();
                           return finding;
                         }});
  group.cases.push_back({.name = "Instead: cameras in float ECEF",
                         .expected = "how far the cameras of these surveys would be moved",
                         .unit = "m",
                         .for_comparison = true,
                         .run = [known] {
                           Worst worst;
                           for (const EarthRun& run : known->runs) worst.Take(run.worst_float_ecef_m);
                           return Finding{.seen = fmt::format("{:.0f} pixels of a GSD of 2 cm", worst.value() / 0.02), .worst = worst.value()};
                         }});
  return group;
}

}  // namespace skyquilt::coordinator::numerics
