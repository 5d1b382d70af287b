// What a stage remembers of how its results were made, so that running again does nothing twice and a changed configuration
// never mixes with old files. Kept in <project>/.state/<stage>.json.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "coordinator/project/project.h"

namespace skyquilt::coordinator {

using FlatOptions = std::map<std::string, std::string>;

struct StageStamp {
  static constexpr const char* kRunning = "running";
  static constexpr const char* kDone = "done";
  static constexpr const char* kFailed = "failed";  // finished, with blocks that failed

  std::string stage;
  std::string state;    // one of the above
  FlatOptions options;  // "section.key" = value of everything the stage's result depends on
  FlatOptions inputs;   // name = hash or description of what it read
  std::string finished_utc = {};
  double seconds = 0.0;

  // Identity of the configuration and the inputs; not of the time.
  std::string Hash() const;
};

enum class Freshness {
  kAbsent,         // never begun: it left no stamp
  kUnfinished,     // begun, failed, or finished but its files are gone, with the same configuration and inputs: continue
  kFresh,          // finished with the same configuration and inputs: nothing to do
  kInputsChanged,  // begun or finished, but what it read is different now
};

// Nothing when there is none. Throws base::InputError when it is damaged.
std::optional<StageStamp> LoadStamp(const Project& project, const std::string& stage);
void SaveStamp(const Project& project, const StageStamp& stamp);

// proof: what must exist for the stage to count as finished.
// Throws base::UsageError naming every difference when the stage's options differ from those of the existing results.
Freshness CheckStage(const Project& project, const std::string& stage, const FlatOptions& options, const FlatOptions& inputs,
                     const std::vector<std::filesystem::path>& proof);

// The entries whose key is in `keys`, or begins with one of them when it ends in '.'.
FlatOptions Select(const FlatOptions& all, const std::vector<std::string>& keys);

// Identity of a file's bytes; "absent" when it does not exist.
std::string FileIdentity(const std::filesystem::path& file);
// Identity of the names, sizes and times of all images below a folder (the folder `except` left out): cheap even for thousands of photos.
std::string PhotosIdentity(const std::filesystem::path& folder, const std::filesystem::path& except);

}  // namespace skyquilt::coordinator
