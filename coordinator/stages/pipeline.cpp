#include "coordinator/stages/pipeline.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "coordinator/project/stamp.h"
#include "coordinator/rendering/scene_session.h"
#include "coordinator/scheduler/field_context.h"
#include "coordinator/scheduler/train_all.h"
#include "coordinator/stages/project_products.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/log.h"
#include "core/base/progress.h"
#include "core/base/system.h"
#include "core/base/thread_pool.h"
#include "evaluate/evaluate.h"
#include "merge/merge.h"
#include "partition/make_blocks.h"
#include "prepare/prepare.h"
#include "simulate/simulate.h"

namespace skyquilt::coordinator {
namespace {

constexpr const char* kDone = "done";
constexpr const char* kFailed = "failed";
constexpr const char* kRunning = "running";

std::string JoinLines(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += "\n  " + line;
  return text;
}

// What happens when a finished stage's inputs are other ones now: the later, cheap stages follow by themselves; nobody's survey, blocks or
// hours of training are thrown away unasked.
enum class OnNewInputs { kAgain, kRefuse };

struct Stage {
  std::string name;
  FlatOptions inputs;
  OnNewInputs on_new_inputs = OnNewInputs::kAgain;
  bool dated = true;  // false for results that must be the same bytes each time: no dates, no copy of the configuration
};

// Runs the body unless its results are fresh; the body returns the state to remember. Returns false when there was nothing to do.
bool RunStage(Pipeline& pipeline, const Stage& stage, const std::function<std::string(const StageStamp&)>& body) {
  const Project& project = pipeline.project;
  if (pipeline.restart) {
    RemoveStagesFrom(project, stage.name);
    pipeline.restart = false;
  }
  StageStamp stamp{.stage = stage.name, .state = kRunning, .options = StageOptions(pipeline.settings, stage.name), .inputs = stage.inputs};
  const Freshness freshness = CheckStage(project, stage.name, stamp.options, stamp.inputs);
  if (freshness == Freshness::kFresh) {
    spdlog::info("{}: nothing to do, the results are there", stage.name);
    return false;
  }
  if (freshness == Freshness::kInputsChanged) {
    const std::string changes = JoinLines(config::Differences(LoadStamp(project, stage.name)->inputs, stage.inputs));
    if (stage.on_new_inputs == OnNewInputs::kRefuse) {
      throw base::UsageError("what '" + stage.name + "' in " + project.folder.string() + " was made from has changed:" + changes +
                             "\nUse another project folder, or --restart to remove the results of '" + stage.name + "' and of all later stages");
    }
    spdlog::info("{}: made again, because its input is new", stage.name);
  }
  SaveStamp(project, stamp);
  if (stage.dated) base::WriteFileAtomically(project.ConfigFile(), pipeline.settings.Toml());
  spdlog::info("{}", stage.name);
  const auto start = std::chrono::steady_clock::now();
  stamp.state = body(stamp);
  if (stage.dated) {
    stamp.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    stamp.finished_utc = base::UtcTimestamp();
  }
  SaveStamp(project, stamp);
  spdlog::debug("{} took {}", stage.name, base::FormatDuration(stamp.seconds));
  return true;
}

std::string SurveyIdentity(const Project& project) {
  return FileIdentity(project.SurveyFolder() / "survey.json") + " " + FileIdentity(project.SurveyFolder() / "points.ply");
}

void RequireFile(const std::filesystem::path& file, const std::string& stage, const Project& project) {
  if (std::filesystem::exists(file)) return;
  throw base::InputError(file, "is not there yet", "Run 'skyquilt " + stage + " " + project.folder.string() + "' first");
}

// The blocks that train.json says are good, and "context".
std::set<std::string> FinishedFields(const Project& project) {
  RequireFile(project.TrainReport(), "train", project);
  try {
    const nlohmann::json report = nlohmann::json::parse(base::ReadFile(project.TrainReport()));
    std::set<std::string> names;
    for (const nlohmann::json& field : report.at("fields")) {
      if (field.at("ok").get<bool>()) names.insert(field.at("name").get<std::string>());
    }
    return names;
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(project.TrainReport(), std::string("is damaged: ") + error.what(), "Run 'skyquilt train' again");
  }
}

}  // namespace

void RequireSameConfiguration(Pipeline& pipeline, const std::string& first) {
  if (pipeline.restart) return;
  const std::vector<std::string>& names = StageNames();
  for (auto it = std::find(names.begin(), names.end(), first); it != names.end(); ++it) {
    // A simulated survey keeps its own stamp, in its own folder.
    if (*it != "simulate") CheckStage(pipeline.project, *it, StageOptions(pipeline.settings, *it), {});
  }
}

void SimulateStage(Pipeline& pipeline, const std::filesystem::path& folder) {
  Pipeline own{.comm = pipeline.comm, .project = Project::Create(folder), .settings = pipeline.settings};
  const bool ours = std::filesystem::exists(own.project.folder / "simulate.json") || std::filesystem::exists(own.project.StampFile("simulate"));
  if (pipeline.restart && ours) {
    for (const auto& entry : std::filesystem::directory_iterator(own.project.folder)) std::filesystem::remove_all(entry.path());
  }
  // The same seed gives the same bytes: no dates.
  RunStage(own, {.name = "simulate", .inputs = {}, .dated = false}, [&own](const StageStamp&) {
    base::ThreadPool threads(own.settings.run.threads);
    simulate::Simulate(own.settings.simulate, own.project.folder, threads);
    return kDone;
  });
}

void PrepareStage(Pipeline& pipeline, const std::filesystem::path& photos, const std::filesystem::path& model) {
  const auto absolute = [](const std::filesystem::path& path) { return path.empty() ? path : std::filesystem::absolute(path).lexically_normal(); };
  if (!std::filesystem::is_directory(photos)) throw base::InputError(photos, "no such folder", "Give the folder that holds the photos");
  if (!model.empty() && !std::filesystem::is_directory(model)) {
    throw base::InputError(model, "no such folder", "Give the folder that holds cameras, images and points3D (.bin or .txt)");
  }
  const prepare::PrepareInput input{.photos = absolute(photos), .model = absolute(model), .out_folder = pipeline.project.SurveyFolder()};
  const FlatOptions inputs = {
      {"photos", input.photos.string()}, {"model", input.model.string()}, {"images", PhotosIdentity(input.photos, pipeline.project.folder)}};
  RunStage(pipeline, {.name = "prepare", .inputs = inputs, .on_new_inputs = OnNewInputs::kRefuse}, [&](const StageStamp&) {
    base::ThreadPool threads(pipeline.settings.run.threads);
    prepare::Prepare(input, pipeline.settings.prepare, threads);
    RequireFile(pipeline.project.SurveyFolder() / "survey.json", "prepare", pipeline.project);
    return kDone;
  });
}

void PartitionStage(Pipeline& pipeline) {
  const Project& project = pipeline.project;
  RequireFile(project.SurveyFolder() / "survey.json", "prepare", project);
  const FlatOptions inputs = {{"survey", SurveyIdentity(project)}};
  RunStage(pipeline, {.name = "partition", .inputs = inputs, .on_new_inputs = OnNewInputs::kRefuse}, [&](const StageStamp& stamp) {
    const survey::Survey survey = survey::LoadSurvey(project.SurveyFolder());
    partition::BlockSet blocks = partition::MakeBlocks(survey, pipeline.settings.partition, pipeline.settings.run.image_width);
    if (blocks.config_hash.empty()) blocks.config_hash = stamp.Hash();
    partition::SaveBlocks(blocks, project.BlocksFile());
    spdlog::info("{} x {} blocks", blocks.rows, blocks.columns);
    for (const partition::Block& block : blocks.blocks) {
      if (block.empty) {
        spdlog::info("  {}: empty, {}", block.name, block.empty_reason);
      } else {
        const Eigen::Vector3d size = block.max_enu - block.min_enu;
        spdlog::info("  {}: {:.0f} x {:.0f} m, {:.1f} m high, {} photos from {:.0f} m, GSD {:.3f} m, table 2^{}", block.name, size.x(), size.y(),
                     size.z(), block.photos.size(), block.altitude_agl_m, block.gsd_m, block.log2_table_size);
      }
    }
    return kDone;
  });
}

std::vector<std::string> TrainStage(Pipeline& pipeline) {
  const Project& project = pipeline.project;
  RequireFile(project.SurveyFolder() / "survey.json", "prepare", project);
  RequireFile(project.BlocksFile(), "partition", project);
  const FlatOptions inputs = {{"survey", SurveyIdentity(project)}, {"blocks", FileIdentity(project.BlocksFile())}};
  TrainSummary summary;
  RunStage(pipeline, {.name = "train", .inputs = inputs, .on_new_inputs = OnNewInputs::kRefuse}, [&](const StageStamp& stamp) {
    const survey::Survey survey = survey::LoadSurvey(project.SurveyFolder());
    const partition::BlockSet blocks = partition::LoadBlocks(project.BlocksFile());
    const TrainInput input{.survey = &survey, .blocks = &blocks, .config_hash = stamp.Hash(), .verbose = pipeline.verbose, .quiet = pipeline.quiet};
    summary = TrainAll(pipeline.comm, input, pipeline.settings, project);
    return summary.failed.empty() ? kDone : kFailed;
  });
  return summary.failed;
}

void MergeStage(Pipeline& pipeline) {
  const Project& project = pipeline.project;
  RequireFile(project.BlocksFile(), "partition", project);
  const std::set<std::string> finished = FinishedFields(project);
  const FlatOptions inputs = {{"train", FileIdentity(project.TrainReport())}, {"blocks", FileIdentity(project.BlocksFile())}};
  RunStage(pipeline, {.name = "merge", .inputs = inputs}, [&](const StageStamp&) {
    const partition::BlockSet blocks = partition::LoadBlocks(project.BlocksFile());
    const std::optional<StageStamp> train = LoadStamp(project, "train");
    merge::MergeInput input{.context = project.ContextCheckpoint(),
                            .blocks = {},
                            .origin = blocks.origin,
                            .georeferenced = blocks.georeferenced,
                            .borders = pipeline.settings.merge.Borders(),
                            .storage = pipeline.settings.merge.Storage(),
                            .use_context = pipeline.settings.train.coupling != "independent",
                            .config_toml = pipeline.settings.Toml(),
                            .config_hash = train ? train->Hash() : "",
                            .scene = project.SceneFile()};
    for (const partition::Block& block : blocks.blocks) {
      if (block.empty) continue;
      if (finished.contains(block.name)) {
        input.blocks.push_back({.checkpoint = project.BlockCheckpoint(block.name), .gsd_m = block.gsd_m});
      } else {
        spdlog::warn("block {} has no finished checkpoint: the context stands in for it", block.name);
      }
    }
    merge::MergeScene(input);
    spdlog::info("{}", project.SceneFile().string());
    return kDone;
  });
}

void ProductsStage(Pipeline& pipeline) {
  const Project& project = pipeline.project;
  RequireFile(project.SceneFile(), "merge", project);
  RunStage(pipeline, {.name = "products", .inputs = {{"scene", FileIdentity(project.StampFile("merge"))}}}, [&](const StageStamp&) {
    SceneSession session(pipeline.comm, project.SceneFile(), pipeline.settings.run, pipeline.verbose, pipeline.quiet);
    MakeProjectProducts(project, pipeline.settings.products, session);
    return kDone;
  });
}

void EvaluateStage(Pipeline& pipeline) {
  const Project& project = pipeline.project;
  RequireFile(project.SceneFile(), "merge", project);
  const FlatOptions inputs = {{"scene", FileIdentity(project.StampFile("merge"))}, {"products", FileIdentity(project.StampFile("products"))}};
  RunStage(pipeline, {.name = "evaluate", .inputs = inputs}, [&](const StageStamp&) {
    SceneSession session(pipeline.comm, project.SceneFile(), pipeline.settings.run, pipeline.verbose, pipeline.quiet);
    base::ThreadPool& threads = session.threads();
    const survey::Survey survey = survey::LoadSurvey(project.SurveyFolder());
    const partition::BlockSet blocks = partition::LoadBlocks(project.BlocksFile());
    std::filesystem::create_directories(project.PixelCacheFile().parent_path());
    const image::PixelCache pixels =
        image::PixelCache::Open(project.PixelCacheFile(), PixelSources(survey), pipeline.settings.run.image_width, threads);
    const evaluate::EvaluateInput input{.scene = &session.scene(),
                                        .survey = &survey,
                                        .blocks = &blocks,
                                        .pixels = &pixels,
                                        .project_folder = project.folder,
                                        .train_json = project.TrainReport(),
                                        .ranks = 0,
                                        .config_text = pipeline.settings.Toml(),
                                        .options = pipeline.settings.evaluate};
    const evaluate::Metrics metrics = evaluate::Evaluate(input, threads);
    spdlog::info("PSNR {:.2f} dB, SSIM {:.3f} over the {:.0f} % covered pixels of {} held-out photos; full frame {:.2f} dB", metrics.psnr,
                 metrics.ssim, 100.0 * metrics.coverage, metrics.n_test, metrics.psnr_full_frame);
    if (metrics.has_truth) {
      spdlog::info("depth: median error {:.2f} m, RMSE {:.2f} m", metrics.depth_median_abs_m, metrics.depth_rmse_m);
    }
    spdlog::info("report: {}", (project.ReportFolder() / "index.html").string());
    return kDone;
  });
}

void ThrowIfBlocksFailed(const std::vector<std::string>& failed, const Project& project) {
  if (failed.empty()) return;
  throw base::BlockError(std::to_string(failed.size()) + " block(s) failed after all tries:" + JoinLines(failed) +
                         "\nThe others are finished and saved in " + project.CheckpointFolder().string() +
                         "; the same command tries the failed ones again");
}

}  // namespace skyquilt::coordinator
