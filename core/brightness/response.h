// How the photos of a survey recorded light, relative to a camera at reference exposure:
//   recorded = light * exif_gain[photo] * exp(log_gain[photo][colour]) * vignetting of its camera at the pixel
// all in linear light. The vignetting is exp(a r^2 + b r^4 + c r^6), r the distance from the principal point over that of the farthest corner:
// 1 on the axis, positive everywhere, and the radial polynomial of Goldman and Chen (2005, eq. 2) to first order.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/brightness/exposure.h"
#include "core/checkpoint/archive.h"

namespace skyquilt::brightness {

struct Response {
  double reference_exposure = 0.0;  // EXIF E that gain 1 stands for; 0 when unknown
  std::vector<float> exif_gain;     // per photo, > 0; 1 where the tags say nothing or are not used
  std::vector<float> log_gain;      // [photo][red, green, blue], natural logarithm; 0 for held-out photos
  std::vector<int64_t> camera;      // per photo
  std::vector<float> vignetting;    // [camera][a, b, c]
  std::vector<uint8_t> names;       // of the photos, one per line; empty when unknown

  static Response Plain(size_t photos, size_t cameras);
  size_t photos() const { return exif_gain.size(); }
  // Natural logarithm of the vignetting of a photo's camera; radius2 = r^2 in [0, 1].
  float LogVignetting(size_t photo, float radius2) const;
  // Natural logarithms of all three factors together; on the axis by default.
  std::array<float, 3> LogGain(size_t photo, float radius2 = 0.0F) const;
  std::array<Exposure, 3> ExposureOf(size_t photo) const;
  // The same at a pixel away from the axis.
  std::array<Exposure, 3> ExposureOf(size_t photo, float radius2) const { return FallenOff(ExposureOf(photo), LogVignetting(photo, radius2)); }
  static std::array<Exposure, 3> FallenOff(std::array<Exposure, 3> exposure, float log_vignetting);
  // The photo of this name: as it is listed, or the only one whose file name it is.
  std::optional<size_t> Find(const std::string& name) const;
};

// Arrays under "response/". The response must outlive the writer's Commit.
void PutResponse(const Response& response, checkpoint::ArchiveWriter& writer);
// Throws base::InputError when arrays disagree. A file without them gives a response of no photos.
Response GetResponse(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file);

}  // namespace skyquilt::brightness
