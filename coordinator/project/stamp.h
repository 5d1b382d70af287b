// Records how a stage's results were made: its options and the identity of its inputs. With it, a repeated command skips finished stages, and
// results of different configurations are never mixed. Kept in <project>/.state/<stage>.json.
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
  static constexpr const char* kFailed = "failed";  // finished, but some blocks failed

  std::string stage;
  std::string state;    // one of the above
  FlatOptions options;  // "section.key" = value of every option that the stage's result depends on
  FlatOptions inputs;   // name = hash or description of each input
  std::string finished_utc = {};
  double seconds = 0.0;
  double rendering_seconds = 0.0;  // of these, for what other ranks do where there are some: rays of the scene, tiles of the orthophoto

  // Identity of stage, options and inputs; date and duration do not count.
  std::string Hash() const;
};

enum class Freshness {
  kNotStarted,     // never started: there is no stamp
  kUnfinished,     // same configuration and inputs, but interrupted, failed, or its files are missing: continue
  kUpToDate,       // finished with the same configuration and inputs: nothing to do
  kInputsChanged,  // started or finished, but its inputs are different now
};

// Empty when there is no stamp. Throws base::InputError when it is damaged.
std::optional<StageStamp> LoadStamp(const Project& project, const std::string& stage);
void SaveStamp(const Project& project, const StageStamp& stamp);

// proof: files that must exist for the stage to count as finished.
// Throws base::UsageError naming every difference when the stage's options differ from those of the existing results.
Freshness CheckStage(const Project& project, const std::string& stage, const FlatOptions& options, const FlatOptions& inputs,
                     const std::vector<std::filesystem::path>& proof);

// The entries whose key is in `keys`. An entry of `keys` that ends in '.' selects its whole section.
FlatOptions Select(const FlatOptions& all, const std::vector<std::string>& keys);

// Identity of a file's bytes; "absent" when it does not exist.
std::string FileIdentity(const std::filesystem::path& file);
// Identity of the names, sizes and modification times of all images below a folder, without the folder `except`. Image content is not read, so
// this is fast even for thousands of photos.
std::string PhotosIdentity(const std::filesystem::path& folder, const std::filesystem::path& except);
// The same of HEIC and raw files without a JPEG, PNG or TIFF of their name beside them, which are photos themselves; empty when there are none.
std::string DevelopedIdentity(const std::filesystem::path& folder, const std::filesystem::path& except);

}  // namespace skyquilt::coordinator
