// Finds photos by the names that files of other programs have for them.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::prepare {

class PhotoNames {
 public:
  // names: relative to the photo folder, '/' separated; repeated ones count once.
  explicit PhotoNames(const std::vector<std::string>& names);

  // All give the index of the name. The same path:
  std::optional<size_t> FindPath(const std::string& path) const;
  // The only photo with this file name, or else the only one with this name less its extension (Metashape's labels); upper and lower case are the
  // same. Folders of `label` do not matter. Nothing when several have the file name.
  std::optional<size_t> FindFileName(const std::string& label) const;
  // The first of the two that finds something.
  std::optional<size_t> Find(const std::string& label) const;

  // With '/' in place of the '\' of Windows paths, which Metashape and Pix4D write, and without "." and "..".
  static std::string Cleaned(std::string label);

 private:
  std::map<std::string, size_t> by_path_;
  std::map<std::string, std::vector<size_t>> by_file_name_, by_stem_;  // keys in lower case
};

}  // namespace skyquilt::prepare
