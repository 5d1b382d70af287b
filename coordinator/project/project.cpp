#include "coordinator/project/project.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::coordinator {

Project Project::Create(const std::filesystem::path& folder) {
  const std::filesystem::path absolute = std::filesystem::absolute(folder).lexically_normal();
  base::RequireWritableFolder(absolute);
  return Project{absolute};
}

bool Project::IsProject(const std::filesystem::path& folder) {
  std::error_code ignored;
  return std::filesystem::exists(folder / ".state" / "prepare.json", ignored) || std::filesystem::exists(folder / "survey" / "survey.json", ignored);
}

Project Project::Open(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw base::InputError(folder, "no such project folder", "Make one with 'skyquilt prepare PHOTOS -o " + folder.string() + "' or 'skyquilt run'");
  }
  if (!IsProject(folder)) {
    throw base::InputError(folder, "is not a skyquilt project: it holds no survey/survey.json",
                           "Give the folder that was named with -o, or start with 'skyquilt prepare'");
  }
  return Create(folder);
}

const std::vector<std::string>& StageNames() {
  static const std::vector<std::string> kNames = {"simulate", "prepare", "partition", "train", "merge", "products", "evaluate"};
  return kNames;
}

std::vector<std::filesystem::path> StageFiles(const Project& project, const std::string& stage) {
  if (stage == "simulate") return {project.SimulatedFolder()};
  if (stage == "prepare") return {project.SurveyFolder()};
  if (stage == "partition") return {project.BlocksFile()};
  if (stage == "train")
    return {project.CheckpointFolder(), project.TrainReport(), project.PixelCacheFile().parent_path(), project.StateFolder() / "training.json"};
  if (stage == "merge") return {project.SceneFile(), project.SceneFile().string() + ".prev"};
  if (stage == "products") return {project.ProductsFolder(), project.RendersFolder()};
  SKYQUILT_CHECK(stage == "evaluate", stage);
  return {project.ReportFolder()};
}

namespace {

// The context and every block that train.json calls trained. A damaged train.json proves nothing, not even the blocks.
std::vector<std::filesystem::path> TrainProof(const Project& project) {
  std::vector<std::filesystem::path> proof = {project.ContextCheckpoint(), project.TrainReport()};
  if (!std::filesystem::exists(project.TrainReport())) return proof;
  const nlohmann::json report = nlohmann::json::parse(base::ReadFile(project.TrainReport()), nullptr, false);
  if (!report.is_object() || !report.contains("fields")) return proof;
  for (const nlohmann::json& field : report["fields"]) {
    if (field.value("ok", false) && field.value("block", -1) >= 0) proof.push_back(project.BlockCheckpoint(field.value("name", "")));
  }
  return proof;
}

}  // namespace

std::vector<std::filesystem::path> StageProof(const Project& project, const std::string& stage) {
  if (stage == "simulate") return {project.folder / "simulate.json"};
  if (stage == "prepare") return {project.SurveyFolder() / "survey.json"};
  if (stage == "partition") return {project.BlocksFile()};
  if (stage == "train") return TrainProof(project);
  if (stage == "merge") return {project.SceneFile()};
  if (stage == "products") return {project.ProductsFolder()};
  SKYQUILT_CHECK(stage == "evaluate", stage);
  return {project.ReportFolder() / "metrics.json"};
}

void RemoveStagesFrom(const Project& project, const std::string& stage) {
  const std::vector<std::string>& names = StageNames();
  const auto first = std::find(names.begin(), names.end(), stage);
  SKYQUILT_CHECK(first != names.end(), stage);
  // Latest first: an interrupted removal never leaves a stage whose inputs are gone.
  for (auto it = names.end(); it != first;) {
    --it;
    std::error_code error;
    std::filesystem::remove(project.StampFile(*it), error);
    for (const std::filesystem::path& path : StageFiles(project, *it)) {
      std::filesystem::remove_all(path, error);
      if (error) throw base::InputError(path, "cannot be removed: " + error.message(), "Check the permissions of the project folder");
    }
  }
}

}  // namespace skyquilt::coordinator
