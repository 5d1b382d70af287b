// Finds all files below the photo folder, and what their folders say of them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace skyquilt::prepare::input {

enum class FoundIn {
  kPlainFolder,      // may hold photos
  kMaskFolder,       //
  kThumbnailFolder,  //
  kResultFolder,     // of another program, or of another project
  kProjectImages,    // images/ of another project: photos, or copies of photos that are there already
  kSystemFolder      // stands for a whole folder that is not looked into
};

struct FoundFile {
  std::string name;  // relative to the root, '/' separated; of a folder with '/' at its end
  FoundIn in = FoundIn::kPlainFolder;
  // Of results, and of images and masks of another project: the outermost folder of results, or the project's, with '/' at its end.
  std::string outer;
  bool project = false;  // `outer` is a project, not a folder of results
  std::string why;       // of all but kPlainFolder: in words
};

// In name order (bytes), whatever order the disk has. Folders in `skip` are left out entirely; `masks` is a folder of masks, or a mask,
// whatever its name (empty: none). Links are followed; those to nothing are left out. Throws base::InputError for folders that cannot be opened or
// are nested deeper than 32 levels.
std::vector<FoundFile> WalkFolder(const std::filesystem::path& root, const std::vector<std::filesystem::path>& skip,
                                  const std::filesystem::path& masks);

}  // namespace skyquilt::prepare::input
