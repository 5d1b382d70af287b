// OpenDroneMap runs a stage again when its options have changed, where ours refuse to mix results; this does the same before each of our stages.
#pragma once

#include <string>

#include "coordinator/stages/pipeline.h"

namespace skyquilt::odm {

// Removes the results of the stage, and of those that build on it, when they were made with other options, or from other files and the stage would
// not run again by itself. Says which. pipeline.photos must be set. Throws base::InputError.
void RemoveIfChanged(const coordinator::Pipeline& pipeline, const std::string& stage);
// The same in any case, for --rerun and --rerun-from.
void RemoveResults(const coordinator::Project& project, const std::string& stage);

}  // namespace skyquilt::odm
