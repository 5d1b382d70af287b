// The communicator for ranks of an MPI launcher; only its .cpp file includes mpi.h.
#pragma once

#include <memory>

#include "core/comm/communicator.h"

namespace skyquilt::comm {

// Initialises MPI; at most once per process. Throws std::runtime_error if MPI cannot start.
std::unique_ptr<Communicator> ConnectMpi();

}  // namespace skyquilt::comm
