// Variants that are made from the photos on, within a total time.
#include <fmt/core.h>

#include <cmath>

#include "bench/study/study.h"
#include "coordinator/stages/timed_run.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/system.h"

namespace skyquilt::bench {
namespace {

constexpr const char* kScoredTau = "2 GSD";

void AddProductScores(const evaluate::metrics::Metrics& metrics, VariantResult* result) {
  if (metrics.ortho) {
    result->ortho_psnr_db = metrics.ortho->psnr_db;
    result->ortho_ssim = metrics.ortho->ssim;
  }
  if (!metrics.surface) return;
  for (const evaluate::surface::SurfaceFScore& score : metrics.surface->agreement.f_scores) {
    if (score.tau == kScoredTau) result->f_score = score.f;
  }
}

}  // namespace

VariantResult Study::RunWithin(const Variant& variant, double within_s) {
  if (options_.survey.place.empty() && coordinator::Project::IsProject(options_.survey.folder)) {
    throw base::UsageError(options_.survey.folder.string() +
                           " is a project, whose poses are known: total times begin with the photos. Give their folder");
  }
  coordinator::Settings settings = SettingsOf(variant);
  settings.run.within_s = within_s;
  const std::string identity = Identity(variant, settings) + fmt::format(" within {:g}", within_s);
  if (std::optional<VariantResult> known = Load(variant, identity)) {
    base::LogInfo("{}: nothing to do, its result is saved", variant.label);
    return *std::move(known);
  }
  base::LogInfo("--- {}", variant.label);
  settings.evaluate.scored_pixels_folder = RunFolder(variant) / "covered";
  coordinator::Pipeline pipeline{.comm = comm_,
                                 .project = coordinator::Project::Create(RunFolder(variant)),
                                 .settings = settings,
                                 .quiet = options_.quiet,
                                 .verbose = options_.verbose};
  base::ResetPeakRss();
  VariantResult result;
  result.name = variant.name;
  try {
    coordinator::UseTotalTime(pipeline);
    coordinator::RequireSameConfiguration(pipeline, "prepare");
    const bool simulated = !options_.survey.place.empty();
    coordinator::RunStages(pipeline, simulated ? coordinator::Project{source_}.SimulatedFolder() : options_.survey.folder, options_.survey.model);
    coordinator::ThrowIfBlocksFailed(pipeline.training, pipeline.project);
    result = Collect(variant, variant, pipeline.training, pipeline.metrics);
    AddProductScores(pipeline.metrics, &result);
  } catch (const base::BlockError& error) {
    result.failure = error.what();
    base::LogError("{}: {}", variant.label, result.failure);
  }
  result.label = variant.label;
  const evaluate::metrics::RunTimes times = pipeline.timed->Times();
  result.wall_seconds = times.used_s;
  for (const evaluate::metrics::StageTimes& stage : times.stages) {
    if (std::isfinite(stage.took_s)) result.stage_seconds.emplace_back(stage.stage, stage.took_s);
  }
  result.given_up = times.given_up;
  if (!result.failure.empty()) return result;
  base::WriteFileAtomically(RunFolder(variant).string() + ".json", ResultJson(result, identity));
  pipeline.timed.reset();  // before its folder is made small
  if (!options_.keep) RemoveLargeFiles(variant);
  return result;
}

}  // namespace skyquilt::bench
