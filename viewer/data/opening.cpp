#include "viewer/data/opening.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string_view>
#include <utility>

#include "coordinator/project/stamp.h"
#include "core/base/checked_json.h"
#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::viewer::opening {
namespace {

std::string ShellWord(const std::string& word) {
  const auto is_plain = [](unsigned char c) {
    return std::isalnum(c) != 0 || c >= 0x80 || std::string_view("_-./+,:@%=").find(static_cast<char>(c)) != std::string_view::npos;
  };
  if (!word.empty() && std::all_of(word.begin(), word.end(), is_plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

}  // namespace

nlohmann::json NullIfUnknown(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json ListOf(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

void AddMissing(OpenedProject* opened, const std::string& what, const std::string& reason, const std::string& advice) {
  opened->description["missing"].push_back({{"what", what}, {"reason", reason}, {"advice", advice}});
}

std::string Command(const OpenedProject& opened, const std::string& words) {
  return "skyquilt " + words + " " + ShellWord(opened.project.folder.string());
}

bool Exists(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::exists(file, error);
}

bool IsUnfinished(const OpenedProject& opened, const std::string& stage) {
  try {
    const auto stamp = coordinator::LoadStamp(opened.project, stage);
    return stamp && stamp->state == coordinator::StageStamp::kRunning;
  } catch (const base::InputError&) {
    return false;
  }
}

JsonFile ReadJson(const std::filesystem::path& file) {
  if (!Exists(file)) return {};
  try {
    nlohmann::json json = base::ParseDocument(base::ReadFile(file));
    if (json.is_object()) return {std::move(json), false};
  } catch (const base::Refused&) {
  } catch (const base::InputError&) {
  }
  return {nullptr, true};
}

}  // namespace skyquilt::viewer::opening
