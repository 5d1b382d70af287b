#include "worker/trainer.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/base/errors.h"
#include "core/brightness/captured_photos.h"
#include "core/brightness/exposure.h"
#include "core/brightness/predict_gains.h"
#include "worker/block_session.h"
#include "worker/field_trainer.h"
#include "worker/make_background.h"
#include "worker/poses/pose_learner.h"
#include "worker/start/point_ranges.h"
#include "worker/start/point_surface.h"
#include "worker/start/starting_occupancy.h"
#include "worker/start/surface_interval.h"
#include "worker/start/tie_point_gains.h"
#include "worker/start/view_count.h"
#include "worker/train_loop.h"

namespace skyquilt::worker {
namespace {

constexpr int64_t kMaxOccupancyCells = 4'000'000;
constexpr double kCellPerVoxel = 3.0;
// Largest display value of a field's colours when gains are learned: white in a photo that was exposed one stop less.
constexpr double kLearnedRange = 1.4;
constexpr double kLuminanceRange = 2.0;

// Largest display value that the training photos can have at reference exposure.
double ColorRange(const survey::Survey& survey, const brightness::Response& response) {
  std::vector<float> gains;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    if (survey.photos[i].is_test) continue;
    const std::array<float, 3> log = response.LogGain(i);
    float darkest = std::min({log[0], log[1], log[2]});
    if (response.shading_grid.On()) {
      const size_t knots = response.shading_grid.knots();
      darkest += *std::min_element(response.shading.data() + i * knots, response.shading.data() + (i + 1) * knots);
    }
    gains.push_back(std::exp(darkest));
  }
  return brightness::ColorRange(gains);
}

// A field without parameters. response: as known so far; learning: whether gains are learned while the field trains.
render::TrainedField MakeTarget(const TrainJob& job, const BlockSpec& spec, bool is_context, const brightness::Luminance& luminance,
                                const brightness::Response& response, bool learning, const PriorOptions& priors) {
  const TrainOptions& options = job.options;
  render::TrainedField f;
  f.name = spec.name;
  f.box = spec.box;
  f.map = is_context ? encoding::SpaceMap::Contracted(f.box.min_enu, f.box.max_enu) : encoding::SpaceMap::Box(f.box.TrainMin(), f.box.TrainMax());
  f.step_m = options.step_voxels * spec.finest_voxel_m;
  auto& grid = f.config.grid;
  grid.levels = options.levels;
  grid.features = options.features;
  grid.log2_table_size = spec.log2_table_size;
  grid.base_resolution = options.base_resolution;
  grid.finest_resolution = std::max<double>(options.base_resolution, 1.0 / (spec.finest_voxel_m * f.map.units_per_metre()));
  for (int axis = 0; axis < 3; ++axis) grid.extent[axis] = std::min(1.0, f.map.extent()[axis]);
  f.config.encoding = encoding::KindNamed(options.encoding);
  f.config.hidden = options.hidden;
  f.config.density_hidden_layers = options.density_hidden_layers;
  f.config.density_activation = field::DensityActivationNamed(options.density_activation);
  f.config.color_hidden_layers = options.color_hidden_layers;
  f.config.sh_degree = options.sh_degree;
  f.config.appearance = options.appearance_codes;
  f.config.color_range = ColorRange(*job.survey, response);
  if (learning) f.config.color_range = std::max(f.config.color_range, kLearnedRange);
  f.config.multisample = options.multisample;
  f.config.scale_features = options.scale_features && f.config.Cones();
  f.config.luminance = luminance.On();
  f.config.normal_head = priors.normals > 0.0;
  // Light that is shown brighter than in the photos, or that was too bright for them.
  if (luminance.On()) f.config.color_range = std::max(f.config.color_range, kLuminanceRange);
  f.occupancy = field::OccupancyGrid::Make(grid.extent, kCellPerVoxel * spec.finest_voxel_m * f.map.units_per_metre(), kMaxOccupancyCells);
  return f;
}

std::vector<int> TrainingPhotos(const survey::Survey& survey, const std::vector<int>& photos) {
  std::vector<int> training;
  std::copy_if(photos.begin(), photos.end(), std::back_inserter(training),
               [&](int photo) { return !survey.photos[static_cast<size_t>(photo)].is_test; });
  return training;
}

bool SearchesEverywhere(const TrainOptions& options) {
  return options.start == "everywhere";
}

AppearanceCodes CodesOf(const TrainJob& job) {
  return {GroupPhotos(*job.survey, job.options.appearance_of), job.options.appearance_codes};
}

// The survey with these poses; nothing without poses.
std::optional<survey::Survey> WithPoses(const survey::Survey& survey, const std::optional<survey::RefinedPoses>& poses) {
  if (!poses) return std::nullopt;
  std::optional<survey::Survey> refined = survey;
  survey::ApplyRefinedPoses(*poses, *refined);
  return refined;
}

void RequireJob(const TrainJob& job) {
  SKYQUILT_CHECK(job.survey != nullptr && job.pixels != nullptr, "a job needs a survey and its pixels");
  SKYQUILT_CHECK(job.response.photos() == job.survey->photos.size() && job.pixels->size() == job.survey->photos.size(),
                 "one gain and one cache entry per photo");
}

}  // namespace

TrainResult TrainContext(const TrainJob& job, const BlockSpec& area, base::ThreadPool& threads, const Reporter& report) {
  RequireJob(job);
  std::optional<SavedSession> saved = OpenSession("context", job);
  if (saved) {
    if (const std::optional<TrainResult> finished = FinishedResult(*saved)) return *finished;
  }
  brightness::Response response = job.response;
  brightness::ResponseLearner learner(response, job.learn);
  const ContextBrightness extras{&response, &learner};
  RaySource source(*job.survey, *job.pixels, response);
  source.SetLeftOut(job.left_out);
  const scene::HeightMap surface = SurfaceOfPoints(*job.survey);
  const PointRanges ranges(*job.survey, source, area.photos, threads);
  ranges.GiveSky(source, threads);
  const std::vector<Tile> tiles = TilesWithEnoughViews(source, *job.survey, area.photos, surface, ranges, job.min_views, threads);
  std::vector<Tile> shown, sky;
  for (const Tile& tile : tiles) (ranges.OpenSky(tile) ? sky : shown).push_back(tile);
  source.SetTiles(std::move(shown), std::move(sky), job.options.empty_ray_share);
  if (!source.HasRays()) {
    TrainResult none;
    none.reason = "no training photo sees the survey area; check the poses in the survey";
    return none;
  }
  const KnownFromTiePoints known = GainsFromTiePoints(*job.survey, *job.pixels, source, job.learn, response, threads);
  if (known.gains) learner.Freeze();
  if (known.shading) learner.shading().Freeze();
  source.UpdateExposures();
  render::TrainedField target = MakeTarget(job, area, true, job.luminance, response, learner.active(), PriorOptions::Off());
  const LuminancePlan luminance{job.luminance, {job.luminance.target, job.luminance.start_log_gain}, true};
  PoseLearner poses(*job.survey, source, job.options.PoseOptions());
  FieldTrainer trainer(target, source, nullptr, job.options, CodesOf(job), job.seed, luminance, &learner, {}, threads, &poses);
  SessionRecord record;
  if (saved) {
    LoadSession(*saved, target, trainer, &record, &extras);
    saved.reset();
  } else {
    trainer.InitializeParameters();
    MarkUnseen(source, *job.survey, area.photos, surface, ranges, job.min_views, target, threads);
    if (SearchesEverywhere(job.options)) {
      StartEverywhere(target);
    } else if (ranges.Empty()) {
      StartFromPoints(*job.survey, target);
    } else {
      StartFromRanges(source, ranges, tiles, target);
    }
    trainer.MeasureFootprints();
  }
  source.UpdateExposures();
  TrainLoop loop("context", job, target, trainer, &extras, record, report);
  if (!loop.Run()) return loop.Failure();
  if (job.learn.Gains()) brightness::PredictGains(brightness::CapturedPhotos(*job.survey), response);
  const std::optional<survey::Survey> refined = poses.On() ? WithPoses(*job.survey, RefinedPosesOf(poses.state(), *job.survey)) : std::nullopt;
  const survey::Survey& survey = refined ? *refined : *job.survey;
  const ContextResults findings{SurfaceIntervals(source, survey, target, threads),
                                MakeBackground(source, survey, surface, ranges, job.seed, threads)};
  return loop.SaveResult(&findings);
}

TrainResult TrainBlock(const TrainJob& given, const BlockSpec& block, const std::filesystem::path& context_checkpoint, base::ThreadPool& threads,
                       const Reporter& report) {
  RequireJob(given);
  TrainJob job = given;
  std::optional<SavedSession> saved = OpenSession("block", job);
  if (saved) {
    const std::optional<TrainResult> finished = FinishedResult(*saved);
    const int earlier = ContinueAttempt(*saved, job);
    if (finished && !(earlier < job.attempt && finished->ShowsContext())) return *finished;
    if (finished) saved.reset();
  }
  // Even independent blocks use the context's brightness.
  LoadedContext loaded = LoadContext(context_checkpoint, &block.photos);
  const LoadedContext* context = job.options.coupling == "guided" ? &loaded : nullptr;
  if (loaded.response.photos() != job.survey->photos.size()) {
    throw base::InputError(
        context_checkpoint,
        "was trained with " + std::to_string(loaded.response.photos()) + " photos, but the survey has " + std::to_string(job.survey->photos.size()),
        "Train it again with --restart");
  }
  std::optional<survey::Survey> refined;
  if (job.options.refine_poses) refined = WithPoses(*job.survey, LoadContextPoses(context_checkpoint, *job.survey));
  if (refined) job.survey = &*refined;
  // The losses of a concealing field know no distances of rays.
  const PriorOptions prior_options = loaded.luminance.On() ? PriorOptions::Off() : job.priors;
  render::TrainedField target = MakeTarget(job, block, false, loaded.luminance, loaded.response, false, prior_options);
  RaySource source(*job.survey, *job.pixels, loaded.response);
  source.SetRejected(job.rejected);
  source.SetLeftOut(job.left_out);
  const scene::HeightMap surface = SurfaceOfPoints(*job.survey);
  const PointRanges ranges(*job.survey, source, block.photos, threads);
  ranges.GiveSky(source, threads);
  const std::vector<Tile> tiles = TilesWithEnoughViews(source, *job.survey, block.photos, surface, ranges, job.min_views, threads);
  ChooseTiles(*job.survey, tiles, target, context, ranges, job.options.empty_ray_share, source, threads);
  if (!source.HasRays()) {
    TrainResult none;
    none.reason = "no training photo shows a surface inside block " + block.name;
    return none;
  }
  const LuminancePlan luminance{loaded.luminance, loaded.luminance_state, false};
  std::optional<PhotoSegments> segments;
  if (prior_options.Segments()) segments.emplace(*job.pixels, TrainingPhotos(*job.survey, block.photos), threads);
  const DepthPoints points = prior_options.Points() ? DepthPoints(*job.survey, source, block.box) : DepthPoints();
  const PointPlanes planes = prior_options.Planes() ? PointPlanes(*job.survey, block.box, block.gsd_m) : PointPlanes();
  const FieldPriors priors{prior_options, segments ? &*segments : nullptr, &points, &planes, &job.survey->directions};
  FieldTrainer trainer(target, source, context != nullptr ? &context->field : nullptr, job.options, CodesOf(job), job.seed, luminance, nullptr,
                       priors, threads);
  SessionRecord record;
  if (saved) {
    LoadSession(*saved, target, trainer, &record, nullptr);
    saved.reset();
  } else {
    trainer.InitializeParameters();
    MarkUnseen(source, *job.survey, block.photos, surface, ranges, job.min_views, target, threads);
    if (SearchesEverywhere(job.options)) {
      StartEverywhere(target);
    } else {
      if (ranges.Empty()) {
        StartFromPoints(*job.survey, target);
      } else {
        StartFromRanges(source, ranges, tiles, target);
      }
      if (context != nullptr) StartFromSurfaces(source, ranges, *job.survey, tiles, *context, target);
    }
    trainer.MeasureFootprints();
  }
  TrainLoop loop("block", job, target, trainer, nullptr, record, report);
  if (!loop.Run()) return loop.Failure();
  if (context != nullptr) loop.SetComparison(CompareWithContext(source, target, *context, job.seed, threads));
  return loop.SaveResult(nullptr);
}

}  // namespace skyquilt::worker
