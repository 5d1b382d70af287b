// Finds a photo's mask by names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace skyquilt::prepare::input {

class MaskIndex {
 public:
  // photos: names relative to the photo folder.
  explicit MaskIndex(const std::vector<std::string>& photos);

  // A file that may be a mask. `name`: relative to the photo folder, as if it lay beside the photos that it can be of: without the folder masks/.
  // Of several with one name the first counts.
  void Add(const std::filesystem::path& file, const std::string& name, bool in_mask_folder);

  // Of this photo alone; masks that were found once count as fitting.
  std::optional<size_t> Find(const std::string& photo);
  // Of all photos in the photo's folder, or in one above; or the only file there is, in a folder of masks, unless it has the name of a photo. To be
  // called after Find for all photos.
  std::optional<size_t> FindShared(const std::string& photo);

  const std::filesystem::path& File(size_t mask) const { return masks_[mask].file; }
  size_t size() const { return masks_.size(); }
  // Files that fit no photo so far.
  std::vector<std::filesystem::path> Unfit() const;
  // Whether any file fits, and whether any lies in a folder of masks.
  bool AnyFits() const;
  bool AnyInMaskFolder() const;

 private:
  struct Mask {
    std::filesystem::path file;
    bool in_mask_folder = false;
    bool fits = false;
  };
  std::optional<size_t> FindKey(const std::string& key);
  // Of one, or of several in different folders.
  bool HasNameOfPhoto(const Mask& mask) const;

  std::vector<Mask> masks_;
  std::map<std::string, size_t> by_name_;                    // keys in lower case
  std::map<std::string, std::vector<size_t>> by_file_name_;  // keys in lower case
  std::map<std::string, size_t> photos_of_stem_;             // how many photos have the stem, in lower case
  std::optional<bool> only_for_all_;
};

}  // namespace skyquilt::prepare::input
