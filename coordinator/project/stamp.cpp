#include "coordinator/project/stamp.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <set>

#include "coordinator/project/settings.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/json_text.h"
#include "core/base/memory_map.h"
#include "core/base/text.h"
#include "core/config/options.h"
#include "core/image/develop.h"
#include "prepare/input/other_projects.h"

namespace skyquilt::coordinator {
namespace {

bool IsPicture(const std::filesystem::path& file) {
  static const std::set<std::string> kImages = {".jpg", ".jpeg", ".png", ".tif", ".tiff"};
  return kImages.contains(base::LowerCase(file.extension().string()));
}

// Without the folder `except`, and without other projects.
std::vector<std::filesystem::path> FilesBelow(const std::filesystem::path& folder, const std::filesystem::path& except) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator it(folder, std::filesystem::directory_options::follow_directory_symlink, error), end;
       !error && it != end; it.increment(error)) {
    if (!except.empty() && it->path().lexically_normal() == except) {
      it.disable_recursion_pending();
      continue;
    }
    // Another project there may still be worked on, and gives no photos.
    std::error_code ignored;
    if (it->is_directory(ignored) && !prepare::input::ProjectKind(it->path()).empty() &&
        !std::filesystem::is_directory(it->path() / "images", ignored)) {
      it.disable_recursion_pending();
      continue;
    }
    if (it->is_regular_file(error)) files.push_back(it->path());
  }
  return files;
}

std::string LineOf(const std::filesystem::path& file, const std::filesystem::path& folder) {
  std::error_code error;
  const auto time = std::chrono::duration_cast<std::chrono::seconds>(std::filesystem::last_write_time(file, error).time_since_epoch()).count();
  return file.lexically_relative(folder).generic_string() + "|" + std::to_string(std::filesystem::file_size(file, error)) + "|" +
         std::to_string(time);
}

std::string IdentityOf(std::vector<std::string> lines) {
  std::sort(lines.begin(), lines.end());
  std::string all;
  for (const std::string& line : lines) all += line + "\n";
  return std::to_string(lines.size()) + " images, " + base::HashHex(all);
}

}  // namespace

std::string StageStamp::Hash() const {
  FlatOptions all = options;
  for (const auto& [name, value] : inputs) all["input:" + name] = value;
  all["stage"] = stage;
  return config::Hash(all);
}

std::optional<StageStamp> LoadStamp(const Project& project, const std::string& stage) {
  const std::filesystem::path file = project.StampFile(stage);
  if (!std::filesystem::exists(file)) return std::nullopt;
  try {
    const nlohmann::json json = base::ParseJson(base::ReadFile(file));
    StageStamp stamp;
    stamp.stage = json.at("stage").get<std::string>();
    stamp.state = json.at("state").get<std::string>();
    Settings settings;
    const config::Sections sections = settings.AllSections();
    for (const auto& [key, value] : json.at("options").get<FlatOptions>()) stamp.options[sections.CurrentName(key, "")] = value;
    stamp.inputs = json.at("inputs").get<FlatOptions>();
    stamp.finished_utc = json.value("finished_utc", "");
    stamp.seconds = json.value("seconds", 0.0);
    stamp.rendering_seconds = json.value("rendering_seconds", 0.0);
    return stamp;
  } catch (const nlohmann::json::exception& error) {
    throw base::InputError(file, std::string("is damaged: ") + error.what(), "Run '" + stage + "' again with --restart");
  }
}

void SaveStamp(const Project& project, const StageStamp& stamp) {
  std::filesystem::create_directories(project.StateFolder());
  const nlohmann::json json = {{"stage", stamp.stage},     {"state", stamp.state},
                               {"options", stamp.options}, {"inputs", stamp.inputs},
                               {"hash", stamp.Hash()},     {"finished_utc", stamp.finished_utc},
                               {"seconds", stamp.seconds}, {"rendering_seconds", stamp.rendering_seconds}};
  base::WriteFileAtomically(project.StampFile(stamp.stage), base::JsonText(json, 2) + "\n");
}

Freshness CheckStage(const Project& project, const std::string& stage, const FlatOptions& options, const FlatOptions& inputs,
                     const std::vector<std::filesystem::path>& proof) {
  const std::optional<StageStamp> stamp = LoadStamp(project, stage);
  if (!stamp) return Freshness::kNotStarted;
  const std::vector<std::string> differences = config::Differences(stamp->options, options);
  if (!differences.empty()) {
    throw base::UsageError("the results of '" + stage + "' in " + project.folder.string() + " were made with another configuration:\n  " +
                           base::Join(differences, "\n  ") + "\nUse the old values, another project folder, or --restart to remove the results of '" +
                           stage + "' and of all later stages");
  }
  const bool complete = std::all_of(proof.begin(), proof.end(), [](const auto& path) { return std::filesystem::exists(path); });
  if (!config::Differences(stamp->inputs, inputs).empty()) return Freshness::kInputsChanged;
  if (stamp->state != StageStamp::kDone) return Freshness::kUnfinished;
  return complete ? Freshness::kUpToDate : Freshness::kUnfinished;
}

FlatOptions Select(const FlatOptions& all, const std::vector<std::string>& keys) {
  FlatOptions selected;
  for (const auto& [key, value] : all) {
    const bool wanted = std::any_of(keys.begin(), keys.end(), [&key = key](const std::string& pattern) {
      return !pattern.empty() && pattern.back() == '.' ? key.rfind(pattern, 0) == 0 : key == pattern;
    });
    if (wanted) selected[key] = value;
  }
  return selected;
}

std::string FileIdentity(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return "absent";
  const base::MemoryMap map(file);
  const std::span<const uint8_t> bytes = map.bytes();
  return base::HashHex(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

std::string PhotosIdentity(const std::filesystem::path& folder, const std::filesystem::path& except) {
  std::vector<std::string> lines;
  for (const std::filesystem::path& file : FilesBelow(folder, except)) {
    if (IsPicture(file)) lines.push_back(LineOf(file, folder));
  }
  return IdentityOf(std::move(lines));
}

std::string DevelopedIdentity(const std::filesystem::path& folder, const std::filesystem::path& except) {
  const std::vector<std::filesystem::path> files = FilesBelow(folder, except);
  const auto name = [](std::filesystem::path file) { return base::LowerCase(file.replace_extension().string()); };
  std::set<std::string> pictures;
  for (const std::filesystem::path& file : files) {
    if (IsPicture(file)) pictures.insert(name(file));
  }
  std::vector<std::string> lines;
  for (const std::filesystem::path& file : files) {
    if (image::NeedsDeveloping(file.filename().string()) && !pictures.contains(name(file))) lines.push_back(LineOf(file, folder));
  }
  return lines.empty() ? std::string() : IdentityOf(std::move(lines));
}

}  // namespace skyquilt::coordinator
