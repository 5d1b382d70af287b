// What the steps of opening a project share.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "viewer/data/open_project.h"

namespace skyquilt::viewer::opening {

constexpr const char* kRestart = " --restart";

// Adds to "missing".
void AddMissing(OpenedProject* opened, const std::string& what, const std::string& reason, const std::string& advice);
// "skyquilt <words> <folder of the project>", as a shell takes it.
std::string Command(const OpenedProject& opened, const std::string& words);

// Whether the stage has started and not ended, for all that its stamp says: it is running, or was interrupted.
bool IsUnfinished(const OpenedProject& opened, const std::string& stage);
bool Exists(const std::filesystem::path& file);

struct JsonFile {
  nlohmann::json json;  // an object; null when it is missing or damaged
  bool damaged = false;
};
JsonFile ReadJson(const std::filesystem::path& file);
nlohmann::json NullIfUnknown(double value);
nlohmann::json ListOf(const Eigen::Vector3d& vector);

}  // namespace skyquilt::viewer::opening
