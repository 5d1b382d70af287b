// How much memory and disk a run needs, and whether the machine has them.
#pragma once

#include <filesystem>

#include "coordinator/planning/work_size.h"
#include "coordinator/project/settings.h"

namespace skyquilt::coordinator {

// Bytes, of one machine.
struct Needs {
  double memory = 0.0;        // for the largest field that the settings allow, or that the blocks have
  double least_memory = 0.0;  // for the smallest: with less nothing can be trained
  double disk = 0.0;          // of the project folder when all stages are done, what is removed on the way included
};

Needs NeedsOf(const WorkSize& size, const Settings& settings);

// Bytes, of this machine.
struct Room {
  double memory_limit = 0.0;  // run.memory_gb
  double disk = 0.0;          // free where the project is; infinite: not known
};
// folder: may not exist yet.
Room RoomFor(const std::filesystem::path& folder, const Settings& settings);

// Throws base::UsageError when nothing can be trained in so little memory, base::InputError that names the folder when the disk is too small. Warns
// when a block may turn out not to fit.
void RequireRoom(const Needs& needs, const Room& room, const std::filesystem::path& folder);

}  // namespace skyquilt::coordinator
