#include "odm/dataset_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <thread>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/base/log.h"

namespace skyquilt::odm {
namespace {

constexpr std::chrono::milliseconds kBetweenTries(20);

// "process 123", as the holder wrote it.
std::string HolderOf(int descriptor) {
  std::array<char, 32> text = {};
  const ssize_t read = pread(descriptor, text.data(), text.size() - 1, 0);
  return read > 0 ? "process " + std::string(text.data(), static_cast<size_t>(read)) : std::string("another process");
}

}  // namespace

DatasetLock::DatasetLock(const std::filesystem::path& project) {
  const std::filesystem::path file = project / "odm.lock";
  descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) throw base::InputError(file, std::string("cannot be made: ") + std::strerror(errno), "Check free space and permissions");
  bool said = false;
  while (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    if (errno != EWOULDBLOCK) return;
    if (!said) base::LogInfo("{} still works on this dataset: waiting for its end", HolderOf(descriptor_));
    said = true;
    if (base::CancelRequested()) {
      close(descriptor_);
      throw base::Interrupted();
    }
    std::this_thread::sleep_for(kBetweenTries);
  }
  // Only a word for the one who waits: on a full disk it is missing.
  const std::string pid = std::to_string(getpid());
  [[maybe_unused]] const bool written = ftruncate(descriptor_, 0) == 0 && pwrite(descriptor_, pid.data(), pid.size(), 0) > 0;
}

DatasetLock::~DatasetLock() {
  close(descriptor_);
}

}  // namespace skyquilt::odm
