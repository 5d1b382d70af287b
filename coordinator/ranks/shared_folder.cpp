#include "coordinator/ranks/shared_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/random.h"

namespace skyquilt::coordinator {
namespace {

constexpr std::chrono::seconds kPatience{5};

}  // namespace

SharedFolder::SharedFolder(const std::filesystem::path& folder) : number_(base::RandomToken()) {
  base::RequireWritableFolder(folder);
  // A new name every time: machines may remember for a while that there is no file of an old one.
  file_ = std::filesystem::absolute(folder) / (".shared_" + number_);
  base::WriteFileAtomically(file_, number_);
}

SharedFolder::~SharedFolder() {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

nlohmann::json SharedFolder::Proof() const {
  return {{"file", file_.string()}, {"number", number_}};
}

void RequireSharedFolder(const nlohmann::json& proof) {
  const std::filesystem::path file = proof.at("file").get<std::string>();
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (true) {
    try {
      if (base::ReadFile(file) == proof.at("number").get<std::string>()) return;
      break;
    } catch (const base::InputError&) {
      // Not there, or not yet.
    }
    if (std::chrono::steady_clock::now() > end) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  throw base::InputError(file.parent_path(), "is not the folder that rank 0 has under this path: what rank 0 wrote there is not seen here",
                         "Put the project on a disk that all machines share, under the same path on each");
}

int64_t BytesSeen(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return -1;
  struct stat status = {};
  const bool known = fstat(descriptor, &status) == 0;
  close(descriptor);
  return known ? status.st_size : -1;
}

}  // namespace skyquilt::coordinator
