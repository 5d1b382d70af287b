// A file or a folder that is made under another name, so that it is either complete or missing under its own. For what other programs and libraries
// write: OutputFile and WriteFileAtomically do this for files of our own.
#pragma once

#include <filesystem>

namespace skyquilt::base {

class PartialPath {
 public:
  // Removes what a killed process has left. partial: beside the target. Throws InputError when that cannot be removed.
  PartialPath(std::filesystem::path target, std::filesystem::path partial);
  // <target>.partial.
  explicit PartialPath(const std::filesystem::path& target) : PartialPath(target, target.string() + ".partial") {}
  ~PartialPath();  // removes it unless it was published
  PartialPath(const PartialPath&) = delete;
  PartialPath& operator=(const PartialPath&) = delete;

  const std::filesystem::path& path() const { return partial_; }
  // As base::Publish.
  void Publish();

 private:
  std::filesystem::path target_, partial_;
  bool published_ = false;
};

}  // namespace skyquilt::base
