#include "prepare/models/reduced_pictures.h"

#include <algorithm>
#include <map>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "prepare/models/poses_bounds.h"

namespace skyquilt::prepare::models {
namespace {

namespace fs = std::filesystem;

bool IsPicture(const fs::path& file) {
  const std::string extension = base::LowerCase(file.extension().string());
  return extension == ".jpg" || extension == ".jpeg" || extension == ".png";
}

// Names of the full-size pictures, in order; those of the model where they are not there.
std::vector<std::string> FullSizeNames(const fs::path& folder, const survey::ColmapModel& sfm) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    if (IsPicture(entry->path())) names.push_back(entry->path().filename().string());
  }
  if (names.empty()) {
    for (const survey::ColmapImage& image : sfm.images) names.push_back(fs::path(image.name).filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

void GiveSmallerNames(const fs::path& scene, const ModelPhotos& photos, survey::ColmapModel& sfm) {
  const std::vector<std::string> full = FullSizeNames(scene / "images", sfm);
  std::vector<std::string> smaller = photos.names();
  std::sort(smaller.begin(), smaller.end());
  if (full.size() != smaller.size()) {
    throw base::InputError(
        photos.root(),
        fmt::format("has {} pictures with other names than those of the model, of which there are {}: it is not known which is which", smaller.size(),
                    full.size()),
        "Give a folder with all pictures of the scene, as it was downloaded, and its images/ beside it");
  }
  std::map<std::string, std::string> smaller_of;
  for (size_t i = 0; i < full.size(); ++i) smaller_of.emplace(full[i], smaller[i]);
  for (survey::ColmapImage& image : sfm.images) {
    const auto found = smaller_of.find(fs::path(image.name).filename().string());
    if (found != smaller_of.end()) image.name = found->second;
  }
  base::LogInfo("the pictures in {} have other names than in the model: they are matched in name order, {} with {} first", photos.root().string(),
                full.front(), smaller.front());
}

}  // namespace

void UseReducedPictures(const fs::path& colmap_folder, const ModelPhotos& photos, InputModel& model) {
  if (colmap_folder.filename() != "0" || colmap_folder.parent_path().filename() != "sparse" || model.sfm.images.empty()) return;
  const fs::path scene = colmap_folder.parent_path().parent_path();
  const auto is_there = [&](const char* name) { return fs::is_directory(scene / name); };
  if (!is_there("images_2") && !is_there("images_4") && !is_there("images_8")) return;
  std::error_code ignored;
  if (!fs::equivalent(photos.root().parent_path(), scene, ignored)) return;  // the photos are elsewhere
  const auto is_photo = [&](const survey::ColmapImage& image) { return photos.Has(photos.Resolve(image.name, scene)); };
  const bool reduced = photos.root().filename().string().starts_with("images_");
  if (reduced && std::none_of(model.sfm.images.begin(), model.sfm.images.end(), is_photo)) GiveSmallerNames(scene, photos, model.sfm);
  std::vector<std::string> names;
  for (const survey::ColmapImage& image : model.sfm.images) names.push_back(image.name);
  std::sort(names.begin(), names.end());
  for (size_t i = 0; i < names.size(); i += kHoldOutEvery) model.test_photos.insert(photos.Resolve(names[i], scene));
  model.set = "LLFF or Mip-NeRF 360";
}

}  // namespace skyquilt::prepare::models
