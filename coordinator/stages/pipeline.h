// The way from photos to report, one function per stage. Each looks at what is there first: it does nothing when its results are fresh,
// continues what was begun, and refuses (base::UsageError) to mix a changed configuration with old files.
// All run on rank 0; training and rendering use the other ranks. Every stage reads its inputs from files, so that stage by stage gives what `run`
// gives, and returns what it found, freshly made or read again where there was nothing to do.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/project/project.h"
#include "coordinator/project/settings.h"
#include "core/comm/communicator.h"
#include "core/scene/train_report.h"
#include "evaluate/metrics.h"

namespace skyquilt::coordinator {

struct Pipeline {
  comm::Communicator& comm;
  Project project;
  Settings settings;
  bool restart = false;  // remove the results of the first stage called and of all later ones
  bool quiet = false;
  bool verbose = false;
  // What "prepare" reads. model empty: COLMAP is run, or the photos are a simulated survey.
  std::filesystem::path photos = {};
  std::filesystem::path model = {};
  // What stages found.
  scene::TrainReport training = {};
  evaluate::Metrics metrics = {};
};

// Throws base::UsageError when any stage from `first` on has results of another configuration; asks before hours of work, not after.
void RequireSameConfiguration(Pipeline& pipeline, const std::string& first);

// A simulated survey in its own folder.
void SimulateStage(Pipeline& pipeline, const std::filesystem::path& folder);
void PrepareStage(Pipeline& pipeline, const std::filesystem::path& photos, const std::filesystem::path& model);
void PartitionStage(Pipeline& pipeline);
// Blocks that failed after all their tries are among its fields, not ok; the rest is finished and saved.
const scene::TrainReport& TrainStage(Pipeline& pipeline);
void MergeStage(Pipeline& pipeline);
// Orthophoto, surface model and video, as [products] says.
void ProductsStage(Pipeline& pipeline);
const evaluate::Metrics& EvaluateStage(Pipeline& pipeline);

// base::BlockError naming those that failed, when there are any.
void ThrowIfBlocksFailed(const scene::TrainReport& training, const Project& project);

}  // namespace skyquilt::coordinator
