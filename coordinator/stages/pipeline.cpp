#include "coordinator/stages/pipeline.h"

#include "coordinator/stages/first_picture.h"
#include "coordinator/stages/stage.h"
#include "coordinator/stages/stage_bodies.h"
#include "coordinator/stages/timed_run.h"
#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "masks/make_masks.h"
#include "prepare/video/find_videos.h"
#include "prepare/video/video_frames.h"

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

void TakePhotos(Pipeline& pipeline, const std::filesystem::path& photos) {
  if (pipeline.videos.empty()) {
    if (!std::filesystem::is_directory(photos)) throw base::InputError(photos, "no such folder", "Give the folder that holds the photos");
    pipeline.photos = std::filesystem::absolute(photos).lexically_normal();
    pipeline.videos = prepare::video::FindVideos({pipeline.photos});
  }
  if (!pipeline.videos.empty()) pipeline.photos = prepare::video::FramesFolder(pipeline.project.SurveyFolder());
}

void PrepareStage(Pipeline& pipeline, const std::filesystem::path& photos, const std::filesystem::path& model) {
  if (!model.empty() && !std::filesystem::exists(model)) {
    throw base::InputError(model, "no such folder or file", "Give the camera model of the photos: a folder or file that docs/input_models.md lists");
  }
  TakePhotos(pipeline, photos);
  pipeline.model = model.empty() ? model : std::filesystem::absolute(model).lexically_normal();
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

void RequireInputs(const Settings& settings, const std::filesystem::path& photos, const std::filesystem::path& model) {
  if (!photos.empty() && !std::filesystem::is_directory(photos)) {
    throw base::InputError(photos, "no such folder", "Give the folder that holds the photos");
  }
  if (!model.empty() && !std::filesystem::exists(model)) {
    throw base::InputError(model, "no such folder or file", "Give the camera model of the photos, or leave --model out to run COLMAP");
  }
  settings.evaluate.RequireFiles();
  if (const std::string& boundary = settings.products.boundary; !boundary.empty() && !std::filesystem::is_regular_file(boundary)) {
    throw base::InputError(boundary, "no such file", "Give a GeoJSON or GeoPackage file as products.boundary, or leave it empty");
  }
  if (const std::string& footprints = settings.buildings.footprints;
      StageNamed("buildings").wanted(settings) && !footprints.empty() && !std::filesystem::is_regular_file(footprints)) {
    throw base::InputError(footprints, "no such file", "Give a file with outlines as buildings.footprints, or leave it empty to find buildings");
  }
  if (const std::string& masks = settings.prepare.masks; !masks.empty() && masks != "none" && !std::filesystem::exists(masks)) {
    throw base::InputError(masks, "no such folder", "Give the folder of the masks, or one mask for all photos, as prepare.masks, or leave it empty");
  }
  masks::CheckFiles(settings.masks);
  for (const std::string* file : {&settings.prepare.gcp, &settings.prepare.gcp_marks}) {
    if (!file->empty() && !std::filesystem::is_regular_file(*file)) {
      throw base::InputError(*file, "no such file", "Give the file of the control points or of their marks, or leave the option empty");
    }
  }
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
