#include "coordinator/scheduler/field_context.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>

#include "coordinator/scheduler/plan_brightness.h"
#include "coordinator/scheduler/training_log.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/encoding/encoding.h"
#include "worker/block_session.h"

namespace skyquilt::coordinator {

std::optional<brightness::Response> EarlierResponse(const Project& project) {
  const std::filesystem::path context = project.Earlier().ContextCheckpoint();
  if (!std::filesystem::exists(context)) return std::nullopt;
  const std::vector<int> no_bands;
  return worker::LoadContext(context, &no_bands).response;
}

std::vector<image::PixelSource> PixelSources(const survey::Survey& survey) {
  std::vector<image::PixelSource> sources;
  for (const survey::Photo& photo : survey.photos) sources.push_back({survey.photo_root / photo.name, photo.mask});
  return sources;
}

worker::BlockSpec SpecOfBlock(const partition::Block& block) {
  worker::BlockSpec spec;
  spec.name = block.name;
  spec.box = block;
  spec.finest_voxel_m = block.finest_voxel_m;
  spec.gsd_m = block.gsd_m;
  spec.log2_table_size = block.log2_table_size;
  spec.photos = block.photos;
  return spec;
}

worker::BlockSpec SpecOfSurvey(const partition::BlockSet& blocks, const survey::Survey& survey, const std::filesystem::path& blocks_file,
                               const Settings& settings) {
  worker::BlockSpec spec;
  spec.name = "context";
  bool any = false;
  size_t n_blocks = 0;
  double finest_block_voxel_m = 0.0;
  for (const partition::Block& block : blocks.blocks) {
    if (block.empty) continue;
    spec.box.min_enu = any ? spec.box.min_enu.cwiseMin(block.min_enu).eval() : block.min_enu;
    spec.box.max_enu = any ? spec.box.max_enu.cwiseMax(block.max_enu).eval() : block.max_enu;
    spec.log2_table_size = any ? std::max(spec.log2_table_size, block.log2_table_size - 1) : block.log2_table_size - 1;
    finest_block_voxel_m = any ? std::min(finest_block_voxel_m, block.finest_voxel_m) : block.finest_voxel_m;
    any = true;
    ++n_blocks;
  }
  if (!any)
    throw base::InputError(blocks_file, "every block is empty, so there is nothing to train",
                           "Check the photos' positions or use larger blocks (--blocks)");
  spec.log2_table_size = std::max(spec.log2_table_size, 1);
  const int doublings = ContextDoublings(n_blocks, spec.log2_table_size, settings);
  spec.log2_table_size += doublings;
  // A thousandth of the survey's width is fine enough: the context shows what is behind a block, seen from far away. Of a large survey it would be
  // many metres, but the context also chooses the pixels and the first occupancy of every block; there voxels shrink as fast as entries of a surface
  // grow.
  const Eigen::Vector3d extent = spec.box.max_enu - spec.box.min_enu;
  spec.finest_voxel_m = std::max(2.0 * finest_block_voxel_m, std::max(extent.x(), extent.y()) / (1024.0 * std::sqrt(std::ldexp(1.0, doublings))));
  spec.photos.resize(survey.photos.size());
  std::iota(spec.photos.begin(), spec.photos.end(), 0);
  return spec;
}

int ContextSteps(const Settings& settings) {
  if (settings.context.steps > 0) return settings.context.steps;
  return settings.train.steps > 0 ? std::max(200, settings.train.steps / 2) : 0;
}

namespace {

double TrainingBytes(int log2_table_size, const worker::TrainOptions& options, int threads) {
  const double entries = std::ldexp(1.0, log2_table_size);
  // Parameters and two moments of every level, once as they are and once as the last good state, and the gradient of one level per thread. Other
  // encodings with tables need as much.
  const bool tables = encoding::KindNamed(options.encoding) != encoding::Kind::kFrequency;
  const double table = !tables ? 0.0 : entries * options.features * 4.0 * (6.0 * options.levels + std::min(threads, options.levels));
  const double per_sample = 4.0 * (2.0 * options.levels * options.features + 6.0 * options.hidden + 64.0);
  return table + per_sample * options.batch_samples + 64e6 * threads;
}

}  // namespace

double ExpectedTrainingBytes(const partition::Block& block, const worker::TrainOptions& options, int threads) {
  return TrainingBytes(block.log2_table_size, options, threads);
}

int ContextDoublings(size_t blocks, int log2_table_size, const Settings& settings) {
  constexpr size_t kBlocks = 64;
  constexpr int kMost = 3, kLargestLog2 = 24;
  constexpr double kShareOfMemory = 0.5;
  const int threads = settings.run.UsableThreads();
  int doublings = 0;
  for (size_t n = 2 * kBlocks; n <= blocks && doublings < kMost; n *= 2) {
    const int larger = log2_table_size + doublings + 1;
    if (larger > kLargestLog2 || TrainingBytes(larger, settings.context, threads) > kShareOfMemory * settings.run.MemoryLimitBytes()) break;
    ++doublings;
  }
  return doublings;
}

double SurveyBytes(const survey::Survey& survey) {
  // Points are also sorted into maps and grids where a training starts, and a tenth of their number is kept for scores.
  constexpr double kCopies = 2.1;
  const size_t points = survey.points.size() * (sizeof(survey::SparsePoint) + sizeof(size_t)) + survey.tracks.observations() * sizeof(int32_t);
  return kCopies * static_cast<double>(points) + static_cast<double>(survey.photos.size() * sizeof(survey::Photo));
}

bool MustStream(const image::PixelCache& pixels, const survey::Survey& survey, const partition::BlockSet& blocks, const Settings& settings,
                int threads, int ranks_on_machine) {
  constexpr double kProgramBytes = 256e6;
  double largest = 0.0;
  for (const partition::Block& block : blocks.blocks) {
    if (!block.empty) largest = std::max(largest, ExpectedTrainingBytes(block, settings.train, threads));
  }
  // Every rank maps the pixels of all photos, so they count for each rank.
  const double per_rank = settings.run.MemoryLimitBytes() / std::max(1, ranks_on_machine);
  return static_cast<double>(pixels.FileBytes()) + largest + SurveyBytes(survey) + kProgramBytes > per_rank;
}

FieldTrainer MakeFieldTrainer(const survey::Survey& survey, const partition::BlockSet& blocks, const image::PixelCache& pixels,
                              const Settings& settings, const Project& project, const std::string& config_hash, base::ThreadPool& threads) {
  const std::optional<brightness::Response> earlier = EarlierResponse(project);
  const BrightnessPlan plan = PlanBrightness(survey, settings.brightness, earlier ? &*earlier : nullptr);
  // Read when the first block is trained: they are found after the context.
  const auto rejected = std::make_shared<std::optional<worker::RejectedPixels>>();
  return [&survey, &blocks, &pixels, &settings, project, config_hash, plan, rejected, &threads](const FieldJob& job, const worker::Reporter& report) {
    worker::TrainJob train;
    train.survey = &survey;
    train.pixels = &pixels;
    train.options = job.block < 0 ? settings.context : settings.train;
    train.priors = settings.priors;
    train.options.steps = job.steps;
    train.options.seconds = job.seconds;
    train.response = plan.response;
    train.learn = plan.learn;
    train.left_out = settings.trust.LeftOut(pixels);
    train.min_views = settings.partition.min_views;
    train.attempt = job.attempt;
    train.learning_rate_scale = job.rate_factor;
    if (train.options.diagnostics) train.diagnostics = project.DiagnosticsLog(job.name);
    train.config_hash = config_hash;
    train.seed = job.seed;
    TrainingLog log(project.TrainLog(job.name));
    const worker::Reporter both = [&log, &report](const worker::TrainStatus& status) {
      log.Add(status);
      if (report) report(status);
    };
    if (job.block < 0) {
      if (settings.brightness.Luminance()) {
        const brightness::BrightnessStatistics statistics = MeasureBrightness(survey, pixels);
        train.luminance = brightness::PlanLuminance(settings.brightness, statistics);
        base::LogInfo("{}", LuminanceRemark(train.luminance, statistics));
      }
      train.checkpoint = project.ContextCheckpoint();
      return worker::TrainContext(train, SpecOfSurvey(blocks, survey, project.BlocksFile(), settings), threads, both);
    }
    if (settings.robust.Any()) {
      if (!*rejected) *rejected = worker::RejectedPixels::Load(config_hash, project.RejectedPixels());
      train.rejected = &**rejected;
    }
    const partition::Block& block = blocks.blocks[static_cast<size_t>(job.block)];
    train.checkpoint = project.BlockCheckpoint(block.name);
    return worker::TrainBlock(train, SpecOfBlock(block), project.ContextCheckpoint(), threads, both);
  };
}

}  // namespace skyquilt::coordinator
