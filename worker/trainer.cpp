#include "worker/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/brightness/captured_photos.h"
#include "core/brightness/exposure.h"
#include "core/brightness/predict_gains.h"
#include "core/render/march.h"
#include "worker/block_session.h"
#include "worker/few_views.h"
#include "worker/field_trainer.h"
#include "worker/make_backdrop.h"
#include "worker/point_surface.h"
#include "worker/starting_occupancy.h"
#include "worker/surface_band.h"
#include "worker/tie_point_gains.h"

namespace skyquilt::worker {
namespace {

constexpr int kOccupancyEvery = 16;
constexpr int kGrowEvery = 128;
constexpr double kGrowUntil = 0.6;       // of the budget; later, cells that hold nothing only cost samples
constexpr double kVisitsToJudge = 16.0;  // samples per occupied cell: fewer, and chance alone leaves cells out
constexpr int kMaxDroppedInARow = 20;
constexpr int64_t kMaxOccupancyCells = 4'000'000;
constexpr double kCellPerVoxel = 3.0;
// Largest display value of a field whose photos' gains are learned: white in a photo of a stop less.
constexpr double kLearnedRange = 1.4;
constexpr double kLuminanceRange = 2.0;

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Largest display value that the training photos, brought to reference exposure, can ask for.
double ColorRange(const survey::Survey& survey, const brightness::Response& response) {
  std::vector<float> gains;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    if (survey.photos[i].is_test) continue;
    const std::array<float, 3> log = response.LogGain(i);
    gains.push_back(std::exp(std::min({log[0], log[1], log[2]})));
  }
  return brightness::ColorRange(gains);
}

// response: as far as it is known; `learning` when more is to be found out while the field trains.
render::TrainedField MakeTarget(const TrainJob& job, const BlockSpec& spec, bool is_context, const brightness::Luminance& luminance,
                                const brightness::Response& response, bool learning) {
  const TrainOptions& options = job.options;
  render::TrainedField f;
  f.name = spec.name;
  f.box = spec.box;
  f.map = is_context ? encoding::SpaceMap::Slab(f.box.min_enu, f.box.max_enu) : encoding::SpaceMap::Box(f.box.TrainMin(), f.box.TrainMax());
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
  f.config.color_hidden_layers = options.color_hidden_layers;
  f.config.sh_degree = options.sh_degree;
  f.config.color_range = ColorRange(*job.survey, response);
  if (learning) f.config.color_range = std::max(f.config.color_range, kLearnedRange);
  f.config.luminance = luminance.On();
  // What is shown brighter than the photos, or was brighter than they could say.
  if (luminance.On()) f.config.color_range = std::max(f.config.color_range, kLuminanceRange);
  f.occupancy = field::OccupancyGrid::Make(grid.extent, kCellPerVoxel * spec.finest_voxel_m * f.map.units_per_metre(), kMaxOccupancyCells);
  return f;
}

TrainResult Summarise(const SessionRecord& record, FieldTrainer& trainer) {
  const field::TrainableState& state = trainer.state();
  TrainResult result;
  result.ok = true;
  result.steps = state.step;
  result.seconds = record.seconds;
  result.samples = record.samples;
  result.rays = record.rays;
  result.parameters = static_cast<int64_t>(state.grid.size() + state.networks.size());
  result.final_psnr_db = RunningPsnr(record);
  result.dropped_steps = record.dropped_steps;
  result.stage_seconds = trainer.StageSeconds();
  return result;
}

// The loop both kinds share. Returns with record.complete = false only when steps kept failing.
class Loop {
 public:
  // extras: the context's, null for blocks.
  Loop(const std::string& kind, const TrainJob& job, render::TrainedField& target, FieldTrainer& trainer, ContextExtras* extras,
       const Reporter& report)
      : kind_(kind), job_(job), target_(target), trainer_(trainer), extras_(extras), report_(report) {}

  TrainResult Run(SessionRecord record, const std::function<ContextFindings()>& find_out) {
    const TrainOptions& options = job_.options;
    const int64_t total_steps = options.steps > 0 ? options.steps : options.seconds > 0.0 ? 0 : kDefaultSteps;
    double last = Now(), last_save = last, last_report = last;
    int dropped_in_a_row = 0;
    field::TrainableState& state = trainer_.state();
    double rays_since = 0.0, samples_since = 0.0, since = 0.0, loss = 0.0;
    const auto fraction_at = [&](int64_t done) {
      return total_steps > 0 ? static_cast<double>(done) / static_cast<double>(total_steps) : record.seconds / std::max(1e-3, options.seconds);
    };
    while (true) {
      const double fraction = fraction_at(state.step);
      if (fraction >= 1.0) break;
      if (base::CancelRequested()) {
        SaveSession(kind_, job_, target_, trainer_, record, extras_);
        throw base::Interrupted();
      }
      const StepResult step = trainer_.Step(fraction, job_.learning_rate_scale);
      if (state.step % kOccupancyEvery == 0) trainer_.UpdateOccupancy(state.step % kGrowEvery == 0 && fraction < kGrowUntil);
      if (step.finite) {
        dropped_in_a_row = 0;
        const double keep = state.step <= 1 ? 0.0 : std::min(0.98, 1.0 - 1.0 / static_cast<double>(state.step));
        record.mean_squared_error = keep * record.mean_squared_error + (1.0 - keep) * step.squared_error;
      } else {
        ++record.dropped_steps;
        if (++dropped_in_a_row >= kMaxDroppedInARow) {
          TrainResult failed = Summarise(record, trainer_);
          failed.ok = false;
          failed.reason = std::to_string(dropped_in_a_row) + " steps in a row were not finite";
          return failed;
        }
      }
      const double now = Now();
      const double step_s = now - last;
      record.seconds += step_s;
      since += step_s;
      last = now;
      record.samples += step.n_samples;
      record.rays += step.n_rays;
      rays_since += step.n_rays;
      samples_since += static_cast<double>(step.n_samples);
      loss = step.loss;
      if (now - last_report >= 0.5) {
        Report(record, fraction, total_steps, loss, rays_since, samples_since, since);
        rays_since = samples_since = since = 0.0;
        last_report = now;
      }
      if (now - last_save >= options.checkpoint_every_s) {
        SaveSession(kind_, job_, target_, trainer_, record, extras_);
        last = last_save = Now();  // saving is not training
      }
    }
    record.complete = true;
    // Cells at the edge of view that no ray happened to cross would show whatever the tables hold there.
    field::OccupancyGrid& cells = target_.occupancy;
    if (static_cast<double>(record.samples) > kVisitsToJudge * cells.OccupiedShare() * static_cast<double>(cells.CellCount())) {
      cells.ForgetUnsampled(kStartDepth);
    }
    if (since > 0.0) Report(record, 1.0, total_steps, loss, rays_since, samples_since, since);
    ContextFindings findings;
    if (extras_ != nullptr) {
      findings = find_out();
      extras_->findings = &findings;
    }
    SaveSession(kind_, job_, target_, trainer_, record, extras_);
    if (extras_ != nullptr) extras_->findings = nullptr;
    return Summarise(record, trainer_);
  }

 private:
  void Report(const SessionRecord& record, double fraction, int64_t total_steps, double loss, double rays, double samples, double seconds) const {
    if (!report_) return;
    TrainStatus status;
    status.step = trainer_.state().step;
    status.fraction = std::min(1.0, fraction);
    status.total_steps = total_steps > 0 ? total_steps : static_cast<int64_t>(static_cast<double>(status.step) / std::max(1e-3, fraction));
    status.seconds = record.seconds;
    status.loss = loss;
    status.psnr_db = RunningPsnr(record);
    status.rays_per_second = rays / std::max(1e-6, seconds);
    status.samples_per_second = samples / std::max(1e-6, seconds);
    status.samples_per_ray = samples / std::max(1.0, rays);
    report_(status);
  }

  std::string kind_;
  const TrainJob& job_;
  render::TrainedField& target_;
  FieldTrainer& trainer_;
  ContextExtras* extras_;
  const Reporter& report_;
};

bool SearchesEverywhere(const TrainOptions& options) {
  return options.start == "everywhere";
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
  ContextExtras extras{&response, &learner, nullptr};
  RaySource source(*job.survey, *job.pixels, response);
  const scene::PlanSurface surface = SurfaceOfPoints(*job.survey);
  source.SetTiles(TilesInCompany(source, *job.survey, area.photos, surface, job.min_views), {}, 0.0);
  if (!source.HasRays()) {
    TrainResult none;
    none.reason = "no training photo sees the survey area";
    return none;
  }
  if (GainsFromTiePoints(*job.survey, *job.pixels, source, job.learn, response, threads)) learner.Rest();
  source.UpdateExposures();
  render::TrainedField target = MakeTarget(job, area, true, job.luminance, response, learner.active());
  const LuminancePlan luminance{job.luminance, {job.luminance.target, job.luminance.start_log_gain}, true};
  FieldTrainer trainer(target, source, nullptr, job.options, job.seed, luminance, &learner, threads);
  SessionRecord record;
  if (saved) {
    LoadSession(*saved, target, trainer, &record, &extras);
    saved.reset();
  } else {
    trainer.InitializeParameters();
    MarkUnseen(source, *job.survey, area.photos, surface, job.min_views, target, threads);
    if (SearchesEverywhere(job.options)) {
      StartEverywhere(target);
    } else {
      StartFromPoints(*job.survey, target);
    }
  }
  source.UpdateExposures();
  Loop loop("context", job, target, trainer, &extras, report);
  return loop.Run(record, [&] {
    target.grid = trainer.state().grid;
    target.networks = trainer.state().networks;
    if (job.learn.Gains()) brightness::PredictGains(brightness::CapturedPhotos(*job.survey), response);
    return ContextFindings{SurfaceBands(source, *job.survey, target, threads), MakeBackdrop(source, *job.survey, surface, job.seed)};
  });
}

TrainResult TrainBlock(const TrainJob& job, const BlockSpec& block, const std::filesystem::path& context_checkpoint, base::ThreadPool& threads,
                       const Reporter& report) {
  RequireJob(job);
  std::optional<SavedSession> saved = OpenSession("block", job);
  if (saved) {
    if (const std::optional<TrainResult> finished = FinishedResult(*saved)) return *finished;
  }
  // Even blocks that do not look at the context share its brightness.
  LoadedContext loaded = LoadContext(context_checkpoint);
  const LoadedContext* context = job.options.coupling == "guided" ? &loaded : nullptr;
  if (loaded.response.photos() != job.survey->photos.size()) {
    throw base::InputError(context_checkpoint, "belongs to a survey of another number of photos", "Train it again with --restart");
  }
  render::TrainedField target = MakeTarget(job, block, false, loaded.luminance, loaded.response, false);
  RaySource source(*job.survey, *job.pixels, loaded.response);
  const scene::PlanSurface surface = SurfaceOfPoints(*job.survey);
  const std::vector<Tile> tiles = TilesInCompany(source, *job.survey, block.photos, surface, job.min_views);
  ChooseTiles(*job.survey, tiles, target, context, job.options.empty_ray_share, source);
  if (!source.HasRays()) {
    TrainResult none;
    none.reason = "no training photo shows a surface inside block " + block.name;
    return none;
  }
  const LuminancePlan luminance{loaded.luminance, loaded.luminance_state, false};
  FieldTrainer trainer(target, source, context != nullptr ? &context->field : nullptr, job.options, job.seed, luminance, nullptr, threads);
  SessionRecord record;
  if (saved) {
    LoadSession(*saved, target, trainer, &record, nullptr);
    saved.reset();
  } else {
    trainer.InitializeParameters();
    MarkUnseen(source, *job.survey, block.photos, surface, job.min_views, target, threads);
    if (SearchesEverywhere(job.options)) {
      StartEverywhere(target);
    } else {
      StartFromPoints(*job.survey, target);
      if (context != nullptr) StartFromBands(source, *job.survey, tiles, *context, target);
    }
  }
  Loop loop("block", job, target, trainer, nullptr, report);
  return loop.Run(record, {});
}

}  // namespace skyquilt::worker
