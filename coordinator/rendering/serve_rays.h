// Rendering on the other ranks: they render the rays that rank 0 sends (see remote_renderer.h), and make parts of jobs: tiles of an orthophoto,
// pieces of a mesh (rank_parts.h).
#pragma once

#include <string>

#include "coordinator/project/settings.h"
#include "core/comm/communicator.h"

namespace skyquilt::coordinator {

// The content of a kTagScene message.
std::string RenderingSetup(const std::filesystem::path& scene_h5, const RunOptions& options, bool verbose, bool quiet);

// Renders and paints what is asked for until kTagDone. Errors are reported to rank 0 and not thrown.
void ServeRays(comm::Communicator& comm, const std::string& setup);

}  // namespace skyquilt::coordinator
