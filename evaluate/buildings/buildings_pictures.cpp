#include "evaluate/buildings/buildings_pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <optional>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "core/image/image.h"

namespace skyquilt::evaluate::buildings {
namespace {

constexpr int kBuildingPictureWidth = 900;  // at most
constexpr int kLeastPictureWidth = 480;     // small parts are enlarged, so that the lines of the model are sharp
constexpr int kLargestScale = 4;
constexpr int kBuildingJpegQuality = 86;

// Of at least `width` pixels across, if the photo has as many.
image::Image8 PhotoOf(const survey::Survey& survey, const image::PixelCache& pixels, size_t photo, int width) {
  const std::filesystem::path file = survey.photo_root / survey.photos[photo].name;
  std::error_code ignored;
  if (pixels.Width(photo) < width && std::filesystem::is_regular_file(file, ignored)) {
    try {
      return image::LoadReducedRgb8(file, width);
    } catch (const base::InputError&) {
      // A photo that was damaged since: the cache has it.
    }
  }
  image::Image8 cached(pixels.Width(photo), pixels.Height(photo), 3);
  cached.data = pixels.Copy(photo).rgb;
  return cached;
}

image::Image8 Cut(const image::Image8& picture, const skyquilt::buildings::PhotoPart& part) {
  image::Image8 cut(part.width, part.height, 3);
  for (int y = 0; y < part.height; ++y) {
    std::copy_n(picture.At(part.left, part.top + y), 3 * static_cast<size_t>(part.width), cut.At(0, y));
  }
  return cut;
}

// Empty when the building is not in the picture.
image::Image8 PictureOfBuilding(const Building& building, const image::Image8& photo, const camera::Camera& camera,
                                const geo::Rigid3d& cam_from_enu) {
  const camera::Camera of_photo = camera.Resized(photo.width, photo.height);
  skyquilt::buildings::PhotoPart part = PartAround(building, of_photo, cam_from_enu);
  part.left = std::clamp(part.left, 0, photo.width);
  part.top = std::clamp(part.top, 0, photo.height);
  part.width = std::min(part.width, photo.width - part.left);
  part.height = std::min(part.height, photo.height - part.top);
  if (part.width < 2 || part.height < 2) return {};
  const int scale = std::clamp(kLeastPictureWidth / part.width, 1, kLargestScale);
  image::Image8 shown = Cut(photo, part);
  if (scale > 1) shown = image::Resize(shown, scale * part.width, scale * part.height);
  const int width = std::min(shown.width, kBuildingPictureWidth);
  camera::Camera of_part = CameraOfPart(of_photo, part, scale);
  if (width < shown.width) {
    shown = image::Resize(shown, width, image::ScaledHeight(shown.width, shown.height, width));
    of_part = of_part.Resized(shown.width, shown.height);
  }
  return DrawModel(building, shown, of_part, cam_from_enu, {0, 0, shown.width, shown.height});
}

}  // namespace

camera::Camera CameraOfPart(const camera::Camera& camera, const skyquilt::buildings::PhotoPart& part, int scale) {
  camera::Camera of_part = camera;
  of_part.width = part.width;
  of_part.height = part.height;
  const size_t x = camera::HasOneFocalLength(camera.model) ? 1 : 2;  // place of the principal point among the parameters
  of_part.params[x] -= part.left;
  of_part.params[x + 1] -= part.top;
  return of_part.Resized(scale * part.width, scale * part.height);
}

std::vector<BuildingPicture> WriteBuildingPictures(const BuildingSet& set, std::span<const size_t> chosen, const survey::Survey& survey,
                                                   const image::PixelCache& pixels, const std::filesystem::path& report_folder) {
  std::vector<BuildingPicture> pictures(set.buildings.size());
  std::map<size_t, std::vector<size_t>> buildings_of_photo;  // so that each photo is read once
  for (const size_t index : chosen) {
    const std::optional<int> photo = BestPhoto(set.buildings[index], survey);
    if (photo) buildings_of_photo[static_cast<size_t>(*photo)].push_back(index);
  }
  for (const auto& [photo_index, shown] : buildings_of_photo) {
    base::ThrowIfCancelled();
    const survey::Photo& photo = survey.photos[photo_index];
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
    // As many pixels as the smallest building in it needs.
    int width = 0;
    for (const size_t index : shown) {
      const int part = std::max(PartAround(set.buildings[index], camera, photo.cam_from_enu).width, 1);
      width = std::max(width, static_cast<int>(static_cast<int64_t>(camera.width) * std::min(part, kBuildingPictureWidth) / part));
    }
    const image::Image8 pixels_of_photo = PhotoOf(survey, pixels, photo_index, width);
    for (const size_t index : shown) {
      const image::Image8 drawn = PictureOfBuilding(set.buildings[index], pixels_of_photo, camera, photo.cam_from_enu);
      if (drawn.Empty()) continue;
      pictures[index] = {fmt::format("images/building_{}.jpg", set.buildings[index].id), photo.name, drawn.width, drawn.height};
      image::SaveJpeg(drawn, report_folder / pictures[index].file, kBuildingJpegQuality);
    }
  }
  return pictures;
}

}  // namespace skyquilt::evaluate::buildings
