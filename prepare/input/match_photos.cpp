#include "prepare/input/match_photos.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "core/base/text.h"
#include "prepare/models/photo_names.h"

namespace skyquilt::prepare::input {
namespace {

namespace fs = std::filesystem;

// The image that a photo is, so far.
struct Claim {
  size_t strength = 0;  // parts of the path in common; the whole path is more than any
  uint32_t image = 0;
  bool is_only = true;  // of this strength
};

}  // namespace

FileOfImage FindPhotos(const survey::ColmapModel& model, const std::vector<PhotoFile>& files) {
  std::vector<std::string> names;
  names.reserve(files.size());
  for (const PhotoFile& file : files) names.push_back(file.name);
  const models::PhotoNames finder(names);
  // Names of other programs may lack the folder, so that several images seem to be one photo.
  std::map<size_t, Claim> claims;
  for (const survey::ColmapImage& image : model.images) {
    const std::optional<size_t> file = finder.Find(image.name);
    if (!file) continue;
    const bool same_path = names[*file] == image.name;
    const Claim claim{same_path ? std::numeric_limits<size_t>::max() : finder.CommonParts(image.name, *file), image.id};
    const auto [known, is_first] = claims.try_emplace(*file, claim);
    if (is_first || claim.strength < known->second.strength) continue;
    if (claim.strength > known->second.strength) {
      known->second = claim;
    } else {
      known->second.is_only = false;
    }
  }
  FileOfImage found;
  for (const auto& [file, claim] : claims) {
    if (claim.is_only) found.emplace(claim.image, file);
  }
  return found;
}

FileOfImage MatchPhotos(const survey::ColmapModel& model, const std::vector<PhotoFile>& files, const fs::path& model_folder,
                        const fs::path& photo_root) {
  const FileOfImage found = FindPhotos(model, files);
  FileOfImage registered;
  std::vector<std::string> missing;
  std::vector<std::string> other_size;
  std::string size_example;
  for (const survey::ColmapImage& image : model.images) {
    const auto file = found.find(image.id);
    if (file == found.end()) {
      missing.push_back(image.name);
      continue;
    }
    const camera::Camera& camera = model.cameras.at(image.camera_id);
    const PhotoFile& photo = files[file->second];
    if (camera.width != photo.width || camera.height != photo.height) {
      other_size.push_back(photo.name);
      size_example = photo.name + " is " + std::to_string(photo.width) + "x" + std::to_string(photo.height) + ", its camera in the model " +
                     std::to_string(camera.width) + "x" + std::to_string(camera.height) + " pixels";
      continue;
    }
    registered.emplace(image.id, file->second);
  }
  if (!missing.empty()) {
    base::LogWarning(
        "{}: {} of {} photos of the model are left out, because they are not in {}, cannot be read or have a name that several share: {}",
        model_folder.string(), missing.size(), model.images.size(), photo_root.string(), FewNames(missing));
  }
  if (!other_size.empty()) {
    base::LogWarning("{} photos are left out, because their size is not that of their camera in the model: {} ({})", other_size.size(),
                     FewNames(other_size), size_example);
  }
  if (registered.size() < kMinPhotos) {
    std::string problem =
        "only " + std::to_string(registered.size()) + " photos of the model can be used, at least " + std::to_string(kMinPhotos) + " are needed";
    if (!missing.empty()) problem += "; " + std::to_string(missing.size()) + " are not in " + photo_root.string() + " (" + FewNames(missing) + ")";
    if (!other_size.empty()) problem += "; " + std::to_string(other_size.size()) + " have another size: " + size_example;
    throw base::InputError(model_folder, problem,
                           other_size.empty()
                               ? "Give the folder with the photos the model was made from"
                               : "Give the photos that the model was made from, in their size or scaled, but neither cropped nor turned");
  }
  return registered;
}

std::vector<PreparedPhoto> PreparePhotos(const survey::ColmapModel& model, const FileOfImage& file_of_image, const std::vector<PhotoFile>& files) {
  std::map<size_t, size_t> image_of_file;  // files are in name order
  for (size_t i = 0; i < model.images.size(); ++i) {
    if (const auto file = file_of_image.find(model.images[i].id); file != file_of_image.end()) image_of_file.emplace(file->second, i);
  }
  std::vector<PreparedPhoto> photos;
  photos.reserve(image_of_file.size());
  for (const auto& [file, image] : image_of_file) photos.push_back(PreparePhoto(files[file], image, model.images[image].cam_from_world));
  return photos;
}

std::string FewNames(const std::vector<std::string>& names) {
  return base::Join(std::span(names).first(std::min<size_t>(names.size(), 5))) + (names.size() > 5 ? ", ..." : "");
}

}  // namespace skyquilt::prepare::input
