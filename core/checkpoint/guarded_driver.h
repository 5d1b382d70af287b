// An HDF5 file driver that hides failed writes from the library. If a write fails (disk full), HDF5 cannot close the file, keeps it open and crashes
// when the process ends. This driver records the first error and reports success for all later operations, so that HDF5 closes normally; the writer
// then discards the file.
#pragma once

#include "core/checkpoint/hdf5_handle.h"

namespace skyquilt::checkpoint {

struct WriteOutcome {
  int error = 0;  // errno of the first failed operation, 0 if none failed
};

// Makes files created with this access property list use the driver. `outcome` must exist until the file is closed. Call under HdfLock.
void UseGuardedDriver(const Handle& file_access, WriteOutcome* outcome);

}  // namespace skyquilt::checkpoint
