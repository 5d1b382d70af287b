// Finds out before hours of work that a machine sees another disk under the same path: rank 0 leaves a file with a random number in the folder, and
// every other rank must read it there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace skyquilt::coordinator {

// Rank 0's side; the destructor removes the file.
class SharedFolder {
 public:
  // Throws base::InputError when the folder cannot be written.
  explicit SharedFolder(const std::filesystem::path& folder);
  ~SharedFolder();
  SharedFolder(const SharedFolder&) = delete;
  SharedFolder& operator=(const SharedFolder&) = delete;
  // For RequireSharedFolder on the other ranks.
  nlohmann::json Proof() const;

 private:
  std::filesystem::path file_;
  std::string number_;
};

// The other ranks' side. Waits some seconds for the file. Throws base::InputError naming the folder.
void RequireSharedFolder(const nlohmann::json& proof);

// Size of a file as this machine sees it now, opened so that network file systems ask their server; -1 when there is none. Not its time of change,
// which parallel file systems bring up to date later.
int64_t BytesSeen(const std::filesystem::path& file);

}  // namespace skyquilt::coordinator
