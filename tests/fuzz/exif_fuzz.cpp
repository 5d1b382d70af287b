// Tags of a photo, through Exiv2.
#include "core/base/file.h"
#include "core/image/image.h"
#include "core/survey/exif.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/support/temporary_folder.h"

namespace skyquilt::fuzz {

std::vector<std::string> Seeds() {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "photo.jpg";
  image::SaveJpeg(image::Image8(16, 8, 3, 128), file, 90);
  std::vector<std::string> seeds = {base::ReadFile(file)};
  survey::PhotoTags tags;
  tags.gps = geo::Geodetic{46.5, 7.25, 812.0};
  tags.relative_altitude_m = 100.0;
  tags.gimbal_pitch_deg = -90.0;
  tags.horizontal_accuracy_m = 1.5;
  tags.vertical_accuracy_m = 2.5;
  tags.dop = 1.2;
  tags.speed_mps = 8.0;
  tags.exposure.time_s = 1.0 / 320.0;
  tags.exposure.f_number = 2.8;
  tags.exposure.iso = 100.0;
  tags.capture_time_s = 1466699519.25;
  tags.make = "Maker";
  tags.model = "Drone";
  survey::WritePhotoTags(tags, file);
  seeds.push_back(base::ReadFile(file));
  return seeds;
}

void Feed(const std::string& bytes) {
  FeedFile("photo.jpg", bytes, survey::ReadPhotoTags);
}

}  // namespace skyquilt::fuzz
