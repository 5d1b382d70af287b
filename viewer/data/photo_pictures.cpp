#include "viewer/data/photo_pictures.h"

#include <fstream>

#include "core/image/image.h"

namespace skyquilt::viewer {
namespace {

constexpr int kQuality = 85;

}  // namespace

std::string PhotoPicture(const std::filesystem::path& photo, int width) {
  const image::Image8 whole = image::LoadReducedRgb8(photo, width);
  const image::Image8 picture = whole.width > width ? image::Resize(whole, width, image::ScaledHeight(whole.width, whole.height, width)) : whole;
  const std::vector<uint8_t> jpeg = image::EncodeJpeg(picture, kQuality);
  return {jpeg.begin(), jpeg.end()};
}

bool IsJpeg(const std::filesystem::path& photo) {
  std::ifstream file(photo, std::ios::binary);
  char start[3] = {};
  file.read(start, sizeof(start));
  return file.gcount() == 3 && start[0] == '\xFF' && start[1] == '\xD8' && start[2] == '\xFF';
}

}  // namespace skyquilt::viewer
