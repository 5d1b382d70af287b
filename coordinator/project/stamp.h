// What a stage remembers of how its results were made, so that running again does nothing twice and a changed configuration
// never mixes with old files. Kept in <project>/.state/<stage>.json.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "coordinator/project/project.h"

namespace skyquilt::coordinator {

using FlatOptions = std::map<std::string, std::string>;

struct StageStamp {
  std::string stage;
  std::string state;    // "running", "done" or "failed" (finished, with blocks that failed)
  FlatOptions options;  // "section.key" = value of everything the stage's result depends on
  FlatOptions inputs;   // name = hash or description of what it read
  std::string finished_utc = {};
  double seconds = 0.0;

  // Identity of the configuration and the inputs; not of the time.
  std::string Hash() const;
};

enum class Freshness {
  kAbsent,         // never run, or its files are gone
  kUnfinished,     // begun with the same configuration: continue
  kFresh,          // finished with the same configuration and inputs: nothing to do
  kInputsChanged,  // finished, but what it read is different now
};

// Nothing when there is none. Throws base::InputError when it is damaged.
std::optional<StageStamp> LoadStamp(const Project& project, const std::string& stage);
void SaveStamp(const Project& project, const StageStamp& stamp);

// Throws base::UsageError naming every difference when the stage's options differ from those of the existing results.
Freshness CheckStage(const Project& project, const std::string& stage, const FlatOptions& options, const FlatOptions& inputs);

// The entries whose key is in `keys`, or begins with one of them when it ends in '.'.
FlatOptions Select(const FlatOptions& all, const std::vector<std::string>& keys);

// Identity of a file's bytes; "absent" when it does not exist.
std::string FileIdentity(const std::filesystem::path& file);
// Identity of the names, sizes and times of all images below a folder (the folder `except` left out): cheap even for thousands of photos.
std::string PhotosIdentity(const std::filesystem::path& folder, const std::filesystem::path& except);

}  // namespace skyquilt::coordinator
