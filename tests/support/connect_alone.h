// A communicator of one process, even when the tests run under an MPI launcher.
#pragma once

#include <cstdlib>
#include <memory>

#include "core/comm/communicator.h"

namespace skyquilt::comm {

inline std::unique_ptr<Communicator> ConnectAlone() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK"}) unsetenv(name);
  return Connect();
}

}  // namespace skyquilt::comm
