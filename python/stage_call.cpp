#include "python/stage_call.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <mutex>
#include <vector>

#include "coordinator/stages/level_settings.h"
#include "coordinator/stages/photo_inputs.h"
#include "coordinator/stages/pipeline.h"
#include "coordinator/stages/stage.h"
#include "coordinator/stages/timed_run.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/log_file.h"
#include "core/base/progress.h"
#include "core/base/text.h"
#include "core/comm/communicator.h"

namespace skyquilt::python {
namespace {

std::mutex one_call;

// What a call changes in the process, and its end restores.
class Surroundings {
 public:
  explicit Surroundings(const StageCall& call) : level_(base::GetLogLevel()) {
    base::SetLogLevel(call.quiet ? base::LogLevel::kWarning : call.verbose ? base::LogLevel::kDebug : base::LogLevel::kInfo);
    base::Progress::SetQuiet(call.quiet || call.progress);
    base::Progress::SetListener(call.progress);
  }
  ~Surroundings() {
    base::Progress::SetListener({});
    base::Progress::SetQuiet(true);
    base::SetLogLevel(level_);
  }
  Surroundings(const Surroundings&) = delete;
  Surroundings& operator=(const Surroundings&) = delete;

 private:
  base::LogLevel level_;
};

void RequireOneRank() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    const char* const ranks = std::getenv(name);
    if (ranks != nullptr && std::atoi(ranks) > 1) {
      throw base::UsageError(std::string("the Python module works in one process, and there are ") + ranks +
                             " ranks: use the program for several (mpirun -n N skyquilt ...)");
    }
  }
}

void RequireNoTour(const coordinator::Settings& settings) {
  if (coordinator::StageNamed("tour").wanted(settings)) {
    throw base::UsageError("the Python module makes no tours (tour.auto): use the program, 'skyquilt tour'");
  }
}

std::vector<std::filesystem::path> ConfigOf(const coordinator::Project& project) {
  if (!std::filesystem::exists(project.ConfigFile())) return {};
  return {project.ConfigFile()};
}

coordinator::Pipeline PipelineOf(comm::Communicator& comm, const StageCall& call, coordinator::Project project, coordinator::Settings settings) {
  return {.comm = comm,
          .project = std::move(project),
          .settings = std::move(settings),
          .restart = call.restart,
          .quiet = call.quiet,
          .verbose = call.verbose};
}

void Simulate(comm::Communicator& comm, const StageCall& call) {
  coordinator::Pipeline pipeline = PipelineOf(comm, call, {}, app::ChosenSettings({}, call.choice));
  coordinator::SimulateStage(pipeline, call.folder);
}

void Prepare(comm::Communicator& comm, const StageCall& call) {
  coordinator::Settings settings = app::ChosenSettings({}, call.choice);
  std::vector<std::filesystem::path> videos = coordinator::VideosAmong(call.photos);
  coordinator::Pipeline pipeline = PipelineOf(comm, call, coordinator::Project::Create(call.folder), std::move(settings));
  const base::LogFile log(pipeline.project.LogFile());
  pipeline.level_settings = app::ChosenForLevelPhotos(call.choice);
  pipeline.videos = std::move(videos);
  coordinator::PrepareStage(pipeline, coordinator::PhotoFolderOf(call.photos, pipeline.project), call.model);
}

void Run(comm::Communicator& comm, const StageCall& call) {
  coordinator::Settings settings = app::ChosenSettings({}, call.choice);
  std::vector<std::filesystem::path> videos = coordinator::VideosAmong(call.photos);
  coordinator::RequireInputs(settings, call.photos.empty() || !videos.empty() ? std::string() : call.photos.front(), call.model);
  RequireNoTour(settings);
  coordinator::Pipeline pipeline = PipelineOf(comm, call, coordinator::Project::Create(call.folder), std::move(settings));
  const base::LogFile log(pipeline.project.LogFile());
  pipeline.level_settings = app::ChosenForLevelPhotos(call.choice);
  pipeline.videos = std::move(videos);
  coordinator::UseTotalTime(pipeline);
  coordinator::RecallLevelSettings(pipeline);
  coordinator::RequireSameConfiguration(pipeline, "prepare");
  coordinator::RunStages(pipeline, coordinator::PhotoFolderOf(call.photos, pipeline.project), call.model);
  coordinator::ThrowIfBlocksFailed(pipeline.training, pipeline.project);
}

void ContinueProject(comm::Communicator& comm, const StageCall& call) {
  using Do = void (*)(coordinator::Pipeline & pipeline);
  static const std::map<std::string, Do> kStages = {
      {"partition", coordinator::PartitionStage},
      {"train", [](coordinator::Pipeline& p) { coordinator::ThrowIfBlocksFailed(coordinator::TrainStage(p), p.project); }},
      {"merge", coordinator::MergeStage},
      {"products", coordinator::ProductsStage},
      {"surface", coordinator::SurfaceStage},
      {"buildings", coordinator::BuildingsStage},
      {"evaluate",
       [](coordinator::Pipeline& p) {
         p.settings.evaluate.RequireFiles();  // before earlier results are removed
         coordinator::EvaluateStage(p);
       }},
  };
  const auto stage = kStages.find(call.stage);
  SKYQUILT_CHECK(stage != kStages.end(), "no stage '" + call.stage + "'");
  const coordinator::Project project = coordinator::Project::Open(call.folder);
  coordinator::Pipeline pipeline = PipelineOf(comm, call, project, app::ChosenSettings(ConfigOf(project), call.choice));
  const base::LogFile log(project.LogFile());
  stage->second(pipeline);
}

}  // namespace

void CallStage(const StageCall& call) {
  const std::unique_lock only(one_call, std::try_to_lock);
  if (!only.owns_lock()) throw base::UsageError("another stage is at work in this process: wait for its end, or use another process");
  RequireOneRank();
  const Surroundings surroundings(call);
  comm::SingleCommunicator comm;
  if (call.stage == "simulate") {
    Simulate(comm, call);
  } else if (call.stage == "prepare") {
    Prepare(comm, call);
  } else if (call.stage == "run") {
    Run(comm, call);
  } else {
    ContinueProject(comm, call);
  }
}

}  // namespace skyquilt::python
