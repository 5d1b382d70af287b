#include "worker/trainer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/brightness/exposure.h"
#include "core/render/march.h"
#include "worker/block_session.h"
#include "worker/field_trainer.h"
#include "worker/starting_occupancy.h"

namespace skyquilt::worker {
namespace {

constexpr int kOccupancyEvery = 16;
constexpr int kMaxDroppedInARow = 20;
constexpr int64_t kMaxOccupancyCells = 4'000'000;
constexpr double kCellPerVoxel = 3.0;
// A step of two finest voxels: interpolation is smooth across cells, and half the samples buy more rays.
constexpr double kStepPerVoxel = 2.0;

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

render::TrainedField MakeTarget(const TrainJob& job, const BoxView& box, bool is_context) {
  const TrainOptions& options = job.options;
  render::TrainedField f;
  f.name = box.name;
  f.core_min_enu = box.min_enu;
  f.core_max_enu = box.max_enu;
  f.margin_m = box.margin_m;
  const Eigen::Vector3d margin(box.margin_m, box.margin_m, 0.0);
  f.map = is_context ? encoding::SpaceMap::Slab(box.min_enu, box.max_enu) : encoding::SpaceMap::Box(box.min_enu - margin, box.max_enu + margin);
  f.step_m = kStepPerVoxel * box.finest_voxel_m;
  auto& grid = f.config.grid;
  grid.levels = options.levels;
  grid.features = options.features;
  grid.log2_table_size = box.log2_table_size;
  grid.base_resolution = options.base_resolution;
  grid.finest_resolution = std::max<double>(options.base_resolution, 1.0 / (box.finest_voxel_m * f.map.units_per_metre()));
  for (int axis = 0; axis < 3; ++axis) grid.extent[axis] = std::min(1.0, f.map.extent()[axis]);
  f.config.hidden = options.hidden;
  f.config.color_hidden_layers = options.color_hidden_layers;
  f.config.sh_degree = options.sh_degree;
  f.config.color_range = brightness::ColorRange(job.gains);
  f.occupancy = field::OccupancyGrid::Make(grid.extent, kCellPerVoxel * box.finest_voxel_m * f.map.units_per_metre(), kMaxOccupancyCells);
  return f;
}

// Depth the context sees at every tile centre.
std::vector<float> TileDepths(const RaySource& source, const survey::Survey& survey, render::TrainedField& context, FieldTrainer& trainer,
                              base::ThreadPool& threads) {
  std::vector<Tile> tiles;
  std::vector<render::Ray> rays;
  for (size_t photo = 0; photo < survey.photos.size(); ++photo) {
    for (int row = 0; row < kTileRows; ++row) {
      for (int column = 0; column < kTileColumns; ++column) {
        const Tile tile{static_cast<int>(photo), static_cast<int16_t>(column), static_cast<int16_t>(row)};
        render::Ray ray;
        source.RayThrough(tile.photo, source.TileCentre(tile), &ray.origin_enu, &ray.direction_enu);
        rays.push_back(ray);
      }
    }
  }
  std::vector<render::RayColor> seen(rays.size());
  context.grid = trainer.state().grid;
  context.networks = trainer.state().networks;
  context.Finish();
  render::FieldSet set;
  set.context = &context;
  render::EngineOptions options;
  options.colour_threshold = 2.0F;  // depth only
  render::RenderRays(set, rays, seen, options, threads);
  std::vector<float> depth(seen.size());
  for (size_t i = 0; i < seen.size(); ++i) depth[i] = seen[i].depth_median;
  return depth;
}

// Sorts a block's tiles by where the context says their surface is.
void ChooseTiles(const TrainJob& job, const BoxView& box, const render::TrainedField& target, const LoadedContext* context, RaySource& source) {
  std::vector<Tile> inside, empty;
  const Eigen::Vector3d low = target.map.min_enu();
  const Eigen::Vector3d high = target.map.max_enu();
  const std::vector<Tile> tiles = TrainingTiles(*job.survey, box.photos);
  const auto depth_at = [&](const Tile& tile, int row, int column) {
    return static_cast<double>(
        context->tile_depth[(static_cast<size_t>(tile.photo) * kTileRows + static_cast<size_t>(row)) * kTileColumns + static_cast<size_t>(column)]);
  };
  const bool know_depth = context != nullptr && context->tile_depth.size() == job.survey->photos.size() * kTileRows * kTileColumns;
  for (const Tile& tile : tiles) {
    Eigen::Vector3d origin, direction;
    source.RayThrough(tile.photo, source.TileCentre(tile), &origin, &direction);
    if (!know_depth) {
      if (!render::FieldStretch(target.map, origin, direction).Empty()) inside.push_back(tile);
      continue;
    }
    // A tile counts when its own or a neighbouring tile's surface lies above the block's ground plan.
    bool any_inside = false, all_behind = true;
    for (int row = std::max(0, tile.row - 1); row <= std::min(kTileRows - 1, tile.row + 1); ++row) {
      for (int column = std::max(0, tile.column - 1); column <= std::min(kTileColumns - 1, tile.column + 1); ++column) {
        const Tile neighbour{tile.photo, static_cast<int16_t>(column), static_cast<int16_t>(row)};
        Eigen::Vector3d o, d;
        source.RayThrough(neighbour.photo, source.TileCentre(neighbour), &o, &d);
        const double depth = depth_at(tile, row, column);
        const render::Stretch stretch = render::FieldStretch(target.map, o, d);
        if (!std::isfinite(depth)) {
          // Nothing known: as good as inside when the ray leaves through the ground.
          const double out_z = o.z() + stretch.t_far * d.z();
          if (!stretch.Empty() && out_z <= low.z() + 1e-6) any_inside = true;
          all_behind = false;
          continue;
        }
        const Eigen::Vector3d p = o + depth * d;
        const bool above = p.x() >= low.x() && p.x() <= high.x() && p.y() >= low.y() && p.y() <= high.y();
        any_inside = any_inside || above;
        all_behind = all_behind && !stretch.Empty() && depth > stretch.t_far + 2.0 * context->field.step_m;
      }
    }
    if (any_inside) {
      inside.push_back(tile);
    } else if (all_behind) {
      empty.push_back(tile);
    }
  }
  source.SetTiles(std::move(inside), std::move(empty), job.options.empty_ray_share);
}

TrainResult Summarise(const SessionRecord& record, const field::TrainableState& state) {
  TrainResult result;
  result.ok = true;
  result.steps = state.step;
  result.seconds = record.seconds;
  result.samples = record.samples;
  result.rays = record.rays;
  result.parameters = static_cast<int64_t>(state.grid.size() + state.networks.size());
  result.final_psnr_db = -10.0 * std::log10(std::max(1e-10, record.mean_squared_error));
  result.dropped_steps = record.dropped_steps;
  return result;
}

// The loop both kinds share. Returns with record.complete = false only when steps kept failing.
class Loop {
 public:
  Loop(const std::string& kind, const TrainJob& job, render::TrainedField& target, FieldTrainer& trainer, const Reporter& report)
      : kind_(kind), job_(job), target_(target), trainer_(trainer), report_(report) {}

  TrainResult Run(SessionRecord record, const std::function<std::vector<float>()>& final_arrays) {
    const TrainOptions& options = job_.options;
    const int64_t total_steps = options.steps > 0 ? options.steps : options.seconds > 0.0 ? 0 : kDefaultSteps;
    double last = Now(), last_save = last, last_report = last;
    int dropped_in_a_row = 0;
    field::TrainableState& state = trainer_.state();
    double rays_since = 0.0, samples_since = 0.0, since = 0.0, loss = 0.0;
    while (true) {
      const double fraction =
          total_steps > 0 ? static_cast<double>(state.step) / static_cast<double>(total_steps) : record.seconds / std::max(1e-3, options.seconds);
      if (fraction >= 1.0) break;
      if (base::CancelRequested()) {
        SaveSession(kind_, job_, target_, trainer_, record, {});
        throw base::Interrupted();
      }
      const StepResult step = trainer_.Step(fraction, job_.learning_rate_scale);
      if (state.step % kOccupancyEvery == 0) trainer_.UpdateOccupancy();
      if (step.finite) {
        dropped_in_a_row = 0;
        const double keep = state.step <= 1 ? 0.0 : std::min(0.98, 1.0 - 1.0 / static_cast<double>(state.step));
        record.mean_squared_error = keep * record.mean_squared_error + (1.0 - keep) * step.squared_error;
      } else {
        ++record.dropped_steps;
        if (++dropped_in_a_row >= kMaxDroppedInARow) {
          TrainResult failed = Summarise(record, state);
          failed.ok = false;
          failed.reason = std::to_string(dropped_in_a_row) + " steps in a row were not finite";
          return failed;
        }
      }
      const double now = Now();
      record.seconds += now - last;
      since += now - last;
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
        SaveSession(kind_, job_, target_, trainer_, record, {});
        last = last_save = Now();  // saving is not training
      }
    }
    record.complete = true;
    if (since > 0.0) Report(record, 1.0, total_steps, loss, rays_since, samples_since, since);
    const std::vector<float> arrays = final_arrays();
    SaveSession(kind_, job_, target_, trainer_, record, arrays);
    return Summarise(record, state);
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
    status.psnr_db = -10.0 * std::log10(std::max(1e-10, record.mean_squared_error));
    status.rays_per_second = rays / std::max(1e-6, seconds);
    status.samples_per_second = samples / std::max(1e-6, seconds);
    status.samples_per_ray = samples / std::max(1.0, rays);
    report_(status);
  }

  std::string kind_;
  const TrainJob& job_;
  render::TrainedField& target_;
  FieldTrainer& trainer_;
  const Reporter& report_;
};

void RequireJob(const TrainJob& job) {
  SKYQUILT_CHECK(job.survey != nullptr && job.pixels != nullptr, "a job needs a survey and its pixels");
  SKYQUILT_CHECK(job.gains.size() == job.survey->photos.size() && job.pixels->size() == job.survey->photos.size(),
                 "one gain and one cache entry per photo");
}

}  // namespace

TrainResult TrainContext(const TrainJob& job, const BoxView& area, base::ThreadPool& threads, const Reporter& report) {
  RequireJob(job);
  render::TrainedField target = MakeTarget(job, area, true);
  RaySource source(*job.survey, *job.pixels, job.gains);
  source.SetTiles(TrainingTiles(*job.survey, area.photos), {}, 0.0);
  if (!source.HasRays()) {
    TrainResult none;
    none.reason = "no training photo sees the survey area";
    return none;
  }
  FieldTrainer trainer(target, source, nullptr, job.options, job.seed, threads);
  SessionRecord record;
  if (!LoadSession("context", job, target, trainer, &record)) {
    trainer.InitializeParameters();
    MarkUnseen(source, *job.survey, area.photos, target, threads);
  }
  if (record.complete) return Summarise(record, trainer.state());
  Loop loop("context", job, target, trainer, report);
  return loop.Run(record, [&] { return TileDepths(source, *job.survey, target, trainer, threads); });
}

TrainResult TrainBlock(const TrainJob& job, const BoxView& block, const std::filesystem::path& context_checkpoint, base::ThreadPool& threads,
                       const Reporter& report) {
  RequireJob(job);
  std::optional<LoadedContext> context;
  if (job.options.coupling == "guided") context = LoadContext(context_checkpoint);
  render::TrainedField target = MakeTarget(job, block, false);
  RaySource source(*job.survey, *job.pixels, job.gains);
  ChooseTiles(job, block, target, context ? &*context : nullptr, source);
  if (!source.HasRays()) {
    TrainResult none;
    none.reason = "no training photo shows a surface inside block " + block.name;
    return none;
  }
  FieldTrainer trainer(target, source, context ? &context->field : nullptr, job.options, job.seed, threads);
  SessionRecord record;
  if (!LoadSession("block", job, target, trainer, &record)) {
    trainer.InitializeParameters();
    MarkUnseen(source, *job.survey, block.photos, target, threads);
    if (context) StartFromContext(*job.survey, context->field, target, threads);
  }
  if (record.complete) return Summarise(record, trainer.state());
  Loop loop("block", job, target, trainer, report);
  return loop.Run(record, [] { return std::vector<float>(); });
}

}  // namespace skyquilt::worker
