// The way from photos to report, one function per stage. Each looks at what is there first: it does nothing when its results are fresh,
// continues what was begun, and refuses (base::UsageError) to mix a changed configuration with old files.
// All run on rank 0; training uses the other ranks. Every stage reads its inputs from files, so that stage by stage gives what `run` gives.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "coordinator/project/project.h"
#include "coordinator/project/settings.h"
#include "core/comm/communicator.h"

namespace skyquilt::coordinator {

struct Pipeline {
  comm::Communicator& comm;
  Project project;
  Settings settings;
  bool restart = false;  // remove the results of the first stage called and of all later ones
  bool quiet = false;
  bool verbose = false;
};

// Throws base::UsageError when any stage from `first` on has results of another configuration; asks before hours of work, not after.
void RequireSameConfiguration(Pipeline& pipeline, const std::string& first);

// A simulated survey in its own folder.
void SimulateStage(Pipeline& pipeline, const std::filesystem::path& folder);
// `model` empty: COLMAP is run, or the photos are a simulated survey.
void PrepareStage(Pipeline& pipeline, const std::filesystem::path& photos, const std::filesystem::path& model);
void PartitionStage(Pipeline& pipeline);
// The blocks that failed after all their tries ("name: reason"); the rest is finished and saved.
std::vector<std::string> TrainStage(Pipeline& pipeline);
void MergeStage(Pipeline& pipeline);
// Orthophoto, surface model and video, as [products] says.
void ProductsStage(Pipeline& pipeline);
void EvaluateStage(Pipeline& pipeline);

// base::BlockError naming them, when there are any.
void ThrowIfBlocksFailed(const std::vector<std::string>& failed, const Project& project);

}  // namespace skyquilt::coordinator
