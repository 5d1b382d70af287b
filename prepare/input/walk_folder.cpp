#include "prepare/input/walk_folder.h"

#include <algorithm>
#include <set>

#include "core/base/errors.h"
#include "prepare/input/file_names.h"
#include "prepare/input/other_projects.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

constexpr int kDeepest = 32;

class Walker {
 public:
  Walker(const fs::path& root, const std::vector<fs::path>& skip, const fs::path& masks) : root_(root), skip_(skip), masks_(masks) {}

  // `folder`: as in a FoundFile that stands for it, whose files get its values.
  void Walk(const FoundFile& folder, int depth) {
    if (depth > kDeepest) {
      throw base::InputError(root_, "has folders nested deeper than 32 levels",
                             "Remove the link to a parent folder that causes this, or give a folder further down");
    }
    std::error_code error;
    std::set<std::string> names;
    for (fs::directory_iterator entry(root_ / folder.name, error), end; !error && entry != end; entry.increment(error)) {
      names.insert(entry->path().filename().string());
    }
    if (error) throw base::InputError(root_ / folder.name, "cannot be listed: " + error.message(), "Check permissions");
    const bool may_be_project = folder.name.empty() || folder.in == FoundIn::kProjectImages;
    const std::string kind = may_be_project ? ProjectKind(root_ / folder.name) : "";
    for (const std::string& name : names) {
      const fs::path path = root_ / folder.name / name;
      std::error_code ignored;
      FoundFile found = folder;
      found.name += name;
      if (fs::is_directory(path, ignored)) {
        found.name += '/';
        if (IsOneOf(path, skip_)) continue;
        EnterFolder(found, name, names, kind);
        if (found.in == FoundIn::kSystemFolder) {
          files_.push_back(std::move(found));
        } else {
          Walk(found, depth + 1);
        }
      } else if (fs::is_regular_file(path, ignored)) {
        if (found.in == FoundIn::kPlainFolder && IsOneOf(path, {masks_})) {
          found.in = FoundIn::kMaskFolder;
          found.why = "mask of all photos";
        }
        files_.push_back(std::move(found));
      }
    }
  }

  std::vector<FoundFile> Sorted() {
    std::sort(files_.begin(), files_.end(), [](const FoundFile& a, const FoundFile& b) { return a.name < b.name; });
    return std::move(files_);
  }

 private:
  static bool IsOneOf(const fs::path& path, const std::vector<fs::path>& folders) {
    return std::any_of(folders.begin(), folders.end(), [&path](const fs::path& folder) {
      std::error_code ignored;
      return !folder.empty() && fs::equivalent(path, folder, ignored);
    });
  }

  // Decides what the folder's files are; until then `found` has the values of its parent.
  void EnterFolder(FoundFile& found, const std::string& name, const std::set<std::string>& siblings, const std::string& parent_kind) const {
    const auto set = [&found](FoundIn in, std::string why) {
      found.in = in;
      found.why = std::move(why);
    };
    if (IsSystemFolder(name)) {
      found.project = false;
      return set(FoundIn::kSystemFolder, IsHiddenName(name) ? "hidden folder" : "folder of a system");
    }
    if (found.in == FoundIn::kMaskFolder || found.in == FoundIn::kThumbnailFolder) return;
    if (found.in == FoundIn::kResultFolder) {
      // The photos of a project are in its images/, their masks beside it.
      if (!found.project) return;
      if (found.name == found.outer + "images/") found.in = FoundIn::kProjectImages;
      if (found.name == found.outer + name + "/" && IsMaskFolder(name)) found.in = FoundIn::kMaskFolder;
      return;
    }
    if (IsOneOf(root_ / found.name, {masks_}) || IsMaskFolder(name)) return set(FoundIn::kMaskFolder, "in a folder of masks");
    if (IsThumbnailFolder(name)) return set(FoundIn::kThumbnailFolder, "in a folder of thumbnails");
    std::string result = ResultFolder(name, siblings, parent_kind);
    // A project inside the images of another is like any other folder there: copies, or photos.
    if (result.empty() && found.in == FoundIn::kPlainFolder) {
      result = ProjectKind(root_ / found.name);
      found.project = !result.empty();
    }
    if (result.empty()) return;
    found.outer = found.name;
    set(FoundIn::kResultFolder, std::move(result));
  }

  fs::path root_;
  std::vector<fs::path> skip_;
  fs::path masks_;
  std::vector<FoundFile> files_;
};

}  // namespace

std::vector<FoundFile> WalkFolder(const fs::path& root, const std::vector<fs::path>& skip, const fs::path& masks) {
  Walker walker(root, skip, masks);
  walker.Walk({}, 0);
  return walker.Sorted();
}

}  // namespace skyquilt::prepare::input
