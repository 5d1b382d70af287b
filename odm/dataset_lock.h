// One 'skyquilt odm' at a time in a dataset. NodeODM starts a task again as soon as it has sent the signals that cancel it, while the cancelled run
// still saves its work.
#pragma once

#include <filesystem>

namespace skyquilt::odm {

class DatasetLock {
 public:
  // Waits until no other process has the lock, and says which one has it; a signal ends the wait with base::Interrupted. The system releases the lock
  // of a process that ends, however it does; the file odm.lock stays in the project folder, which must be there. Throws base::InputError when the
  // file cannot be made. A file system without locks is used without.
  explicit DatasetLock(const std::filesystem::path& project);
  ~DatasetLock();
  DatasetLock(const DatasetLock&) = delete;
  DatasetLock& operator=(const DatasetLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace skyquilt::odm
