// The stages from photos to report, one function each. A stage does nothing when its results are up to date, continues when it was interrupted,
// and refuses (base::UsageError) to mix a changed configuration with old files.
// All stages run on rank 0; the search for poses, training and rendering use the other ranks too. Every stage reads its inputs from files, so running
// stage by stage gives the same results as `run`.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/project/project.h"
#include "coordinator/project/settings.h"
#include "core/comm/communicator.h"
#include "core/scene/train_report.h"
#include "evaluate/metrics/metrics.h"
#include "tour/export/export_parts.h"

namespace skyquilt::coordinator {

class TimedRun;

struct Pipeline {
  comm::Communicator& comm;
  Project project;
  Settings settings;
  bool restart = false;  // remove the results of the first stage that is called and of all later stages
  bool adds = false;     // photos of "prepare" that a finished project does not have are added to it (addition.h)
  bool quiet = false;
  bool verbose = false;
  // Taken instead of `settings` once the photos are known to look level (level_settings.h); differs in no option of "prepare". None: `settings` hold
  // for all photos.
  std::optional<Settings> level_settings = {};
  // Inputs of "prepare". model may be empty: COLMAP is run, or the photos are a simulated survey.
  std::filesystem::path photos = {};
  std::filesystem::path model = {};
  // Videos whose frames are the photos. Video files are put here before RunStages or PrepareStage, which then need no folder; those of a folder
  // without photos are found there.
  std::vector<std::filesystem::path> videos = {};
  // Page and files of an exported tour, which the viewer has too: stage "tour" needs it.
  std::function<tour::ExportParts(const Project& project)> tour_parts = {};
  // Keeps run.within_s in RunStages (timed_run.h); null: the stages take as long as they take.
  std::shared_ptr<TimedRun> timed = {};
  double rendering_s =
      0.0;  // that the present stage has taken for rays, tiles of maps and pieces of meshes, which other ranks make where there are some
  // Results of "train" and "evaluate"; read from their files when the stage had nothing to do.
  scene::TrainReport training = {};
  evaluate::metrics::Metrics metrics = {};
};

// Throws base::UsageError when `first` or any later stage has results of another configuration. Called before the first stage, so that a conflict
// is found before hours of work and not after.
void RequireSameConfiguration(Pipeline& pipeline, const std::string& first);

// Makes a simulated survey in its own folder.
void SimulateStage(Pipeline& pipeline, const std::filesystem::path& folder);
// Sets pipeline.photos and videos. `photos`: a folder of photos, or of videos; not used when pipeline.videos are given. Throws base::InputError.
void TakePhotos(Pipeline& pipeline, const std::filesystem::path& photos);
// Also chooses between settings and level_settings when it makes a survey, and writes level_settings to config.toml, for later commands. Makes the
// first picture (first_picture.h) as soon as it can, unless there is one.
void PrepareStage(Pipeline& pipeline, const std::filesystem::path& photos, const std::filesystem::path& model);
// Makes masks of the survey, as chosen in [masks]; all later stages use them.
void MasksStage(Pipeline& pipeline);
void PartitionStage(Pipeline& pipeline);
// Blocks that failed after all their tries have ok = false in the report; the others are finished and saved.
const scene::TrainReport& TrainStage(Pipeline& pipeline);
void MergeStage(Pipeline& pipeline);
// Makes orthophoto, surface model, elevations and video, as chosen in [products].
void ProductsStage(Pipeline& pipeline);
// Makes mesh, point cloud, tiles and terrain, as chosen in [surface].
void SurfaceStage(Pipeline& pipeline);
// Finds and measures buildings in the surface, as chosen in [buildings].
void BuildingsStage(Pipeline& pipeline);
// Renders the facades of these buildings (ids, from 1; empty: all) into buildings/facades. The stage must be finished. Throws base::UsageError for an
// id that there is none of.
void WriteFacades(Pipeline& pipeline, const std::vector<int>& ids);
struct TourRequest {
  std::filesystem::path out;
  int auto_stops = 0;  // propose a tour with so many stops; 0: there must be one
  bool video = false;  // also write tour.mp4
};
// Stage "tour" for any folder: exports the project's tour; proposes one first where that is asked for. Throws base::UsageError when there is one then
// that a person made.
void ExportProjectTour(Pipeline& pipeline, const TourRequest& request);
const evaluate::metrics::Metrics& EvaluateStage(Pipeline& pipeline);
// Files and folders that a run of all stages will read: photos (empty: a survey is simulated), model (empty: none), and what options name. Throws
// base::InputError for one that is not there, so that it is found before hours of work.
void RequireInputs(const Settings& settings, const std::filesystem::path& photos, const std::filesystem::path& model);
// `run`: all stages that the settings ask for. photos may be empty: a survey is simulated, in the project's folder.
void RunStages(Pipeline& pipeline, const std::filesystem::path& photos, const std::filesystem::path& model);

// Throws base::BlockError with the names of the failed blocks, if there are any.
void ThrowIfBlocksFailed(const scene::TrainReport& training, const Project& project);

}  // namespace skyquilt::coordinator
