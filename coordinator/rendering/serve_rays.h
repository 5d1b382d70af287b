// One rendering as every rank but the first sees it.
#pragma once

#include <string>

#include "coordinator/project/settings.h"
#include "core/comm/communicator.h"

namespace skyquilt::coordinator {

// What kTagScene carries.
std::string RenderingSetup(const std::filesystem::path& scene_h5, const RunOptions& options, bool verbose, bool quiet);

// Answers rays until kTagDone. Never throws for what a rendering met.
void ServeRays(comm::Communicator& comm, const std::string& setup);

}  // namespace skyquilt::coordinator
