#include "core/brightness/captured_photos.h"

#include <algorithm>

namespace skyquilt::brightness {

bool AllTimed(const survey::Survey& survey) {
  return std::all_of(survey.photos.begin(), survey.photos.end(), [](const survey::Photo& photo) { return photo.time_s.has_value(); });
}

std::vector<CapturedPhoto> CapturedPhotos(const survey::Survey& survey) {
  const bool timed = AllTimed(survey);
  std::vector<CapturedPhoto> captured;
  for (size_t i = 0; i < survey.photos.size(); ++i) {
    const survey::Photo& photo = survey.photos[i];
    const int group = photo.flight * static_cast<int>(survey.cameras.size()) + photo.camera;
    const bool tagged = ExifExposure(photo.exposure.time_s, photo.exposure.f_number, photo.exposure.iso).has_value();
    captured.push_back({timed ? *photo.time_s : static_cast<double>(i), group, !photo.is_test, tagged});
  }
  return captured;
}

}  // namespace skyquilt::brightness
