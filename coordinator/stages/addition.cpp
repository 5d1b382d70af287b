#include "coordinator/stages/addition.h"

#include <nlohmann/json.hpp>
#include <set>

#include "coordinator/scheduler/kept_blocks.h"
#include "coordinator/stages/stage.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/log.h"
#include "prepare/input/zones.h"

namespace skyquilt::coordinator {
namespace {

namespace fs = std::filesystem;

// Links where the file system has them: files are replaced and never written into.
void Keep(const fs::path& from, const fs::path& to) {
  if (!fs::exists(from)) return;
  fs::create_directories(to.parent_path());
  std::error_code error;
  fs::create_hard_link(from, to, error);
  if (!error) return;
  fs::copy_file(from, to, error);
  if (error) throw base::InputError(to, "cannot be written: " + error.message(), "Check permissions and free space of the project folder");
}

// A finished training of what the project has now.
bool IsTrained(const Pipeline& pipeline) {
  const std::optional<StageStamp> stamp = LoadStamp(pipeline.project, "train");
  if (!stamp || stamp->state == StageStamp::kRunning) return false;
  const Stage& train = StageNamed("train");
  for (const Stage::RequiredFile& required : train.required) {
    if (!fs::exists(required.file(pipeline.project))) return false;
  }
  return stamp->inputs == train.inputs(pipeline);
}

void KeepAll(const Project& project) {
  const Project before = project.Earlier();
  const Project made{before.folder.string() + ".new"};
  fs::remove_all(made.folder);
  for (const char* name : {"survey.json", "points.ply", "kept_points.ply", "tracks.bin", "directions.json"}) {
    // Copies: the survey's files are written in place.
    const fs::path from = project.SurveyFolder() / name;
    if (!fs::exists(from)) continue;
    fs::create_directories(made.SurveyFolder());
    fs::copy_file(from, made.SurveyFolder() / name);
  }
  Keep(project.BlocksFile(), made.BlocksFile());
  Keep(project.ContextCheckpoint(), made.ContextCheckpoint());
  Keep(project.TrainLedgerFile(), made.TrainLedgerFile());
  Keep(project.StampFile("prepare"), made.StampFile("prepare"));
  Keep(project.StampFile("train"), made.StampFile("train"));
  nlohmann::json identities = nlohmann::json::object();
  for (const partition::Block& block : partition::LoadBlocks(project.BlocksFile()).blocks) {
    const fs::path file = project.BlockCheckpoint(block.name);
    if (!block.empty && fs::exists(file)) identities[block.name] = FileIdentity(file);
  }
  base::WriteFileAtomically(made.CheckpointIdentities(), base::JsonText(identities, 1) + "\n");
  fs::remove_all(before.folder);
  base::Rename(made.folder, before.folder);
}

}  // namespace

void BeginAddition(const Pipeline& pipeline) {
  const Project& project = pipeline.project;
  if (pipeline.settings.masks.Any()) {
    throw base::UsageError("photos cannot be added to a project with masks that are made ([masks]): prepare all photos together, with --restart");
  }
  if (IsTrained(pipeline)) {
    KeepAll(project);
  } else if (!IsAddition(project)) {
    throw base::UsageError("photos can be added once " + project.folder.string() +
                           " is trained: finish it with its present photos first, or give all photos together, with --restart");
  }
  base::LogInfo("photos are added to {}: its poses, and blocks that no added photo shows, stay as they are", project.folder.string());
}

bool IsAddition(const Project& project) {
  return fs::exists(project.Earlier().SurveyFolder() / "survey.json");
}

bool FollowsAddition(const Project& project, const std::string& stage) {
  return (stage == "partition" || stage == "train") && IsAddition(project);
}

prepare::EarlierSurvey EarlierSurveyOf(const Project& project) {
  const std::optional<StageStamp> stamp = LoadStamp(project.Earlier(), "prepare");
  if (!stamp) throw base::InputError(project.Earlier().folder, "is damaged", "Prepare all photos again, with --restart");
  return {.folder = project.Earlier().SurveyFolder(), .photos = stamp->inputs.at("photos")};
}

void RemoveChangedFields(const Project& project) {
  const survey::Survey survey = survey::LoadSurvey(project.SurveyFolder());
  std::set<std::string> kept;
  for (const FieldOutcome& outcome : KeptBlocks(project, survey, partition::LoadBlocks(project.BlocksFile()), false)) {
    for (const char* ending : {".h5", ".h5.prev", ".log.csv", ".diagnostics.csv"}) kept.insert(outcome.job.name + ending);
  }
  if (fs::is_directory(project.CheckpointFolder())) {
    for (const fs::directory_entry& entry : fs::directory_iterator(project.CheckpointFolder())) {
      if (!kept.contains(entry.path().filename().string())) fs::remove_all(entry.path());
    }
  }
  fs::remove_all(project.MoversFolder());
  fs::remove(project.TrainReport());
}

fs::path FolderWithAdded(const Project& project, const std::vector<fs::path>& folders) {
  const std::optional<StageStamp> stamp = LoadStamp(project, "prepare");
  if (!stamp) throw base::UsageError(project.folder.string() + " has no photos yet, so none can be added: leave --add out");
  if (stamp->inputs.contains("videos")) {
    throw base::UsageError("photos cannot be added to frames of videos: give all of them together in another project");
  }
  return prepare::input::AddZones(stamp->inputs.at("photos"), folders, project.ZonesFolder());
}

}  // namespace skyquilt::coordinator
