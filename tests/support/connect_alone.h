// A communicator of one process, even when the test programs themselves run under a launcher.
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
