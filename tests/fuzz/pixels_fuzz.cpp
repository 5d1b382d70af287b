// Headers of photos, and bands of TIFFs.
#include <vector>

#include "core/gis/photo_bands.h"
#include "core/image/image.h"
#include "core/image/pixel_format.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/raw_tiff.h"

namespace skyquilt::fuzz {

std::vector<std::string> Seeds() {
  const std::vector<uint8_t> jpeg = image::EncodeJpeg(image::Image8(16, 8, 3, 128), 90);
  std::vector<std::string> seeds = {{jpeg.begin(), jpeg.end()}};
  for (const int bands : {1, 3, 5}) {
    for (const int bits : {8, 16}) {
      const auto n = static_cast<size_t>(4 * 3 * bands * bits / 8);
      seeds.push_back(test::TiffBytes({.width = 4,
                                       .height = 3,
                                       .bands = bands,
                                       .bits = bits,
                                       .floating = false,
                                       .photometric = bands == 3 ? 2 : 1,
                                       .extra = std::vector<uint16_t>(bands == 5 ? 4 : 0, 0),
                                       .pixels = std::vector<uint8_t>(n, 7),
                                       .more = {{281, 4095}}}));
    }
  }
  return seeds;
}

void Feed(const std::string& bytes) {
  image::PixelFormatOf({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
  FeedFile("photo.tif", bytes, [](const std::filesystem::path& file) {
    const gis::PhotoBands photo(file);
    // Wide rows of many bands would only show how much memory there is.
    if (photo.width() > 4096 || photo.bands() > 64) return;
    std::vector<int> bands;
    for (int band = 1; band <= photo.bands(); ++band) bands.push_back(band);
    std::vector<float> values(static_cast<size_t>(photo.width()) * bands.size());
    photo.ReadRows(0, 1, bands, values);
  });
}

}  // namespace skyquilt::fuzz
