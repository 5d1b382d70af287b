// An HDF5 file driver for writing that keeps failed writes from the library: HDF5 cannot close a file whose last writes fail (disk full),
// keeps it open for good and crashes when the process ends. Here the first failure is remembered, everything after it is pretended,
// HDF5 closes in peace, and the writer throws the file away.
#pragma once

#include "core/checkpoint/hdf5_handle.h"

namespace skyquilt::checkpoint {

struct WriteOutcome {
  int error = 0;  // the system's number of the first failure, 0 while all is well
};

// Makes files created with this access list use the driver. `outcome` must live until the file is closed. Call under HdfLock.
void UseGuardedDriver(const Handle& file_access, WriteOutcome* outcome);

}  // namespace skyquilt::checkpoint
