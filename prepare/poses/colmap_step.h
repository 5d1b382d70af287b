// Runs commands of the COLMAP program, and remembers which steps are finished.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/base/errors.h"

namespace skyquilt::prepare::poses {

struct ColmapJob {
  std::filesystem::path photo_root;  // names of photos are relative to it
  std::filesystem::path masks;       // empty: none
  std::filesystem::path folder;      // for COLMAP's database, models and log, and for our stamps of finished steps
  std::string log = "colmap.log";    // its name in the folder
  std::string models = "sparse";     // folder of the mapper's models in the folder

  std::filesystem::path Database() const { return folder / "database.db"; }
  std::filesystem::path Models() const { return folder / models; }
  std::filesystem::path Log() const { return folder / log; }
};

struct ColmapCommand {
  std::filesystem::path program;
  std::string name;  // of the command
  std::vector<std::string> arguments;
  std::vector<std::string> environment = {};  // "NAME=value"
};

// The photos and matches give no model: other matches may.
class NoModelError : public base::InputError {
 public:
  using base::InputError::InputError;
};

// Appends the output to the job's log and passes each line on. Throws base::InputError that names the log when the command fails (NoModelError when
// the mapper ends by itself without a model), base::Interrupted when asked to stop.
void RunColmapCommand(const ColmapJob& job, const ColmapCommand& command, const std::function<void(const std::string& line)>& on_line);
// With a line of progress in photos, as far as the output tells it.
void RunWithProgress(const ColmapJob& job, const ColmapCommand& command, const std::string& label, size_t n_photos);

// Share of a step that is done after this line of COLMAP's output, in [0, 1]; negative when the line does not tell.
double ColmapLineProgress(const std::string& line, size_t n_photos);

// A step of the job that is finished has a file with the hash of what its result depends on.
struct ColmapStep {
  std::string name;  // of its file
  std::string hash;
};
bool IsDone(const ColmapJob& job, const ColmapStep& step);
void MarkDone(const ColmapJob& job, const ColmapStep& step);
void ForgetStep(const ColmapJob& job, const std::string& name);
// Does the step unless it is done. `later`: the steps that must follow again.
void RunStep(const ColmapJob& job, const ColmapStep& step, const std::vector<std::string>& later, const std::function<void()>& run);

constexpr const char* kNoModelFix = "The photos may overlap too little or be blurred: read the log, add photos, or give a model with --model";

// Make the models of the job's folder `models`; the other steps fill the database.
constexpr const char* kModelStep = "model";
constexpr const char* kHeldFocalStep = "model_held_focal";  // with the focal lengths of the tags
// Makes a model with one pose per shot of a rig of it, or of one by tags.
constexpr const char* kRigStep = "rigs";

}  // namespace skyquilt::prepare::poses
