// The folder of an export: built beside its place as <folder>.partial and moved there when it is complete. While the files are moved, index.html,
// without which there is no tour, is absent: a kill leaves the old export, or none, or the new one. Files in the folder that are not of an export
// stay.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/base/output_file.h"

namespace skyquilt::tour {

// Files and folders of an export, as far as there are any; index.html first.
std::vector<std::string> ExportedNames();

class StagedFolder {
 public:
  // expected: names of other files and folders that may be in the folder. Removes what a killed export left. Throws base::InputError when the folder
  // has something else in it but no export, and when nothing can be written beside it.
  StagedFolder(const std::filesystem::path& folder, const std::set<std::string>& expected);

  const std::filesystem::path& partial() const { return partial_->path(); }
  // Moves all files and folders of partial(), index.html last. Those of the old export that the new one does not have are removed.
  void Publish();

 private:
  std::filesystem::path folder_;
  std::optional<base::PartialPath> partial_;  // never published as a whole
};

}  // namespace skyquilt::tour
