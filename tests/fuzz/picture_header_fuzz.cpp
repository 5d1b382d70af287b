// Headers of pictures, which the list of the photo folder reads of every file.
#include "core/image/image.h"
#include "prepare/input/picture_header.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/prepare/input/made_folder.h"

namespace skyquilt::fuzz {

std::vector<std::string> Seeds() {
  const std::vector<uint8_t> jpeg = image::EncodeJpeg(image::Image8(16, 8, 3, 128), 90);
  return {std::string(jpeg.begin(), jpeg.end()), image::EncodePng(image::Image8(16, 8, 4, 128), 1), test::TiffHeader(16, 8, 4, 1),
          test::TiffHeader(16, 8, 1, -1, true)};
}

void Feed(const std::string& bytes) {
  prepare::input::ParsePictureHeader({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
}

}  // namespace skyquilt::fuzz
