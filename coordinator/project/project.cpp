#include "coordinator/project/project.h"

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

Project Project::OpenToRead(const std::filesystem::path& folder) {
  std::error_code ignored;
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw base::InputError(folder, "no such project folder", "Make one with 'skyquilt prepare PHOTOS -o " + folder.string() + "' or 'skyquilt run'");
  }
  if (!IsProject(folder)) {
    throw base::InputError(folder, "is not a skyquilt project: it holds no survey/survey.json",
                           "Give the folder that was named with -o, or start with 'skyquilt prepare'");
  }
  return Project{std::filesystem::absolute(folder).lexically_normal()};
}

Project Project::Open(const std::filesystem::path& folder) {
  return Create(OpenToRead(folder).folder);
}

}  // namespace skyquilt::coordinator
