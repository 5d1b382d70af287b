// Finds photos by the names that files of other programs have for them.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::prepare::models {

class PhotoNames {
 public:
  // names: relative to the photo folder, '/' separated; repeated ones count once.
  explicit PhotoNames(const std::vector<std::string>& names);

  // All give the index of the name. The same path:
  std::optional<size_t> FindPath(const std::string& path) const;
  // The only photo with this file name, or else the only one with this name less its extension (Metashape's labels); upper and lower case are the
  // same. Folders of `label` do not matter. Nothing when several have the file name.
  std::optional<size_t> FindFileName(const std::string& label) const;
  // The first of the two that finds something; else, of several photos with the file name, the one that has most folders above it in common with
  // `label` ("D:\\survey\\b\\1.JPG" is b/1.JPG and not a/1.JPG). Quotes and spaces around `label` do not matter.
  std::optional<size_t> Find(const std::string& label) const;
  // How many of the last parts of the path `label` has in common with that photo's; the file name is one, upper and lower case are the same.
  size_t CommonParts(const std::string& label, size_t index) const;

  // With '/' in place of the '\' of Windows paths, which Metashape and Pix4D write, and without "." and "..".
  static std::string Cleaned(std::string label);

 private:
  std::vector<std::string> names_;
  std::map<std::string, size_t> by_path_;
  std::map<std::string, std::vector<size_t>> by_file_name_, by_stem_;  // keys in lower case
};

}  // namespace skyquilt::prepare::models
