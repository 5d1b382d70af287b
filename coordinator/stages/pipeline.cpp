#include "coordinator/stages/pipeline.h"

#include "coordinator/stages/first_picture.h"
#include "coordinator/stages/stage.h"
#include "coordinator/stages/stage_bodies.h"
#include "coordinator/stages/timed_run.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"

namespace skyquilt::coordinator {
namespace {

void LogLevelPhotos(const products::ProductKinds& kinds) {
  base::LogInfo("photos look level: made are {} instead of orthophoto, surface model, terrain and buildings (products.kinds = auto)",
                products::NamesOf(kinds));
}

}  // namespace

void SimulateStage(Pipeline& pipeline, const std::filesystem::path& folder) {
  Pipeline own{.comm = pipeline.comm, .project = Project::Create(folder), .settings = pipeline.settings};
  const bool ours = std::filesystem::exists(own.project.folder / "simulate.json") || std::filesystem::exists(own.project.StampFile("simulate"));
  if (pipeline.restart && ours) {
    for (const auto& entry : std::filesystem::directory_iterator(own.project.folder)) std::filesystem::remove_all(entry.path());
  }
  RunStage(own, "simulate");
}

void PrepareStage(Pipeline& pipeline, const std::filesystem::path& photos, const std::filesystem::path& model) {
  const auto absolute = [](const std::filesystem::path& path) { return path.empty() ? path : std::filesystem::absolute(path).lexically_normal(); };
  if (!std::filesystem::is_directory(photos)) throw base::InputError(photos, "no such folder", "Give the folder that holds the photos");
  if (!model.empty() && !std::filesystem::exists(model)) {
    throw base::InputError(model, "no such folder or file", "Give the camera model of the photos: a folder or file that docs/input_models.md lists");
  }
  pipeline.photos = absolute(photos);
  pipeline.model = absolute(model);
  RunStage(pipeline, "prepare");
  ProvideFirstPicture(pipeline);
}

void MasksStage(Pipeline& pipeline) {
  RunStage(pipeline, "masks");
}

void PartitionStage(Pipeline& pipeline) {
  RunStage(pipeline, "partition");
}

const scene::TrainReport& TrainStage(Pipeline& pipeline) {
  RunStage(pipeline, "train");
  return pipeline.training;
}

void MergeStage(Pipeline& pipeline) {
  RunStage(pipeline, "merge");
}

void ProductsStage(Pipeline& pipeline) {
  RunStage(pipeline, "products");
}

void SurfaceStage(Pipeline& pipeline) {
  RunStage(pipeline, "surface");
}

void BuildingsStage(Pipeline& pipeline) {
  RunStage(pipeline, "buildings");
}

const evaluate::metrics::Metrics& EvaluateStage(Pipeline& pipeline) {
  RunStage(pipeline, "evaluate");
  return pipeline.metrics;
}

void RunStages(Pipeline& pipeline, const std::filesystem::path& photos, const std::filesystem::path& model) {
  const std::filesystem::path folder = photos.empty() ? pipeline.project.SimulatedFolder() : photos;
  products::ProductKinds kinds;
  for (const Stage& stage : Stages()) {
    if (stage.name == "simulate") {
      if (photos.empty()) SimulateStage(pipeline, folder);
      if (pipeline.timed) pipeline.timed->Start(pipeline, folder, model);
      continue;
    }
    if (pipeline.timed) pipeline.timed->Decide(pipeline, stage.name);
    if (stage.name == "buildings" && !kinds.buildings) continue;
    // Masks that are no longer asked for must not stay in use.
    const bool made = stage.name == "masks" && LoadStamp(pipeline.project, stage.name);
    if (stage.wanted != nullptr && !stage.wanted(pipeline.settings) && !made) continue;
    if (pipeline.timed) pipeline.timed->Began(stage.name);
    if (stage.name == "prepare") {
      PrepareStage(pipeline, folder, model);
      kinds = KindsOf(pipeline);
      if (kinds.along_cameras) LogLevelPhotos(kinds);
    } else {
      RunStage(pipeline, stage.name);
    }
    if (pipeline.timed) pipeline.timed->Ended(pipeline, stage.name);
  }
}

void ThrowIfBlocksFailed(const scene::TrainReport& training, const Project& project) {
  const std::vector<std::string> failed = training.Failed();
  if (failed.empty()) return;
  throw base::BlockError(std::to_string(failed.size()) + " block(s) failed after all tries:\n  " + base::Join(failed, "\n  ") +
                         "\nThe others are finished and saved in " + project.CheckpointFolder().string() +
                         "; the same command tries the failed ones again");
}

}  // namespace skyquilt::coordinator
