// The camera response of a survey: how bright each photo recorded the light of the scene, so that photos of different brightness can train one
// field. Relative to a camera at reference exposure, in linear light:
//   recorded = light * exif_gain[photo] * exp(log_gain[photo][colour]) * vignetting of its camera at the pixel * shading of the photo at the pixel
// Vignetting is exp(a r^2 + b r^4 + c r^6), r = distance from the principal point divided by that of the farthest corner: 1 on the optical axis,
// positive everywhere, and to first order the radial polynomial of Goldman and Chen (2005, eq. 2). Shading: shading.h.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/brightness/exposure.h"
#include "core/brightness/shading.h"
#include "core/checkpoint/archive.h"

namespace skyquilt::brightness {

struct Response {
  double reference_exposure = 0.0;  // EXIF exposure E at gain 1, the median of training photos (exposure.h); 0 when unknown
  std::vector<float> exif_gain;     // per photo, > 0; 1 where tags are missing or not used
  std::vector<float> log_gain;      // [photo][red, green, blue], natural logarithm; 0 for held-out photos until PredictGains
  std::vector<int64_t> camera;      // per photo: index into vignetting
  std::vector<float> vignetting;    // [camera][a, b, c]
  std::vector<uint8_t> names;       // of the photos, one per line, UTF-8; empty when unknown
  ShadingGrid shading_grid;         // the same for all photos; off: no shading
  std::vector<float> shading;       // [photo][row][column], natural logarithm; 0 for held-out photos; empty without shading
  float shading_sigma = 0.0F;       // prior of the shading (ShadingOptions); 0 without it

  // All gains 1, no vignetting, every photo of camera 0.
  static Response Neutral(size_t photos, size_t cameras);
  size_t photos() const { return exif_gain.size(); }
  // Natural logarithm of the vignetting of a photo's camera. radius2: r^2, in [0, 1].
  float LogVignetting(size_t photo, float radius2) const;
  // Natural logarithm of the shading of a photo at a place of its picture; 0 without shading.
  float LogShading(size_t photo, const PicturePlace& place) const { return shading.empty() ? 0.0F : InterpolatedShading(photo, place); }
  // Gives all photos a shading of 0.
  void AddShading(const ShadingGrid& grid, float sigma);
  // Natural logarithm of the product of the first three factors, per colour; on the optical axis by default.
  std::array<float, 3> LogGain(size_t photo, float radius2 = 0.0F) const;
  // Per colour, on the optical axis.
  std::array<Exposure, 3> ExposureOf(size_t photo) const;
  // Per colour, at a pixel with this r^2, without shading and with it.
  std::array<Exposure, 3> ExposureOf(size_t photo, float radius2) const { return WithFactor(ExposureOf(photo), LogVignetting(photo, radius2)); }
  std::array<Exposure, 3> ExposureOf(size_t photo, float radius2, const PicturePlace& place) const {
    return WithFactor(ExposureOf(photo), LogVignetting(photo, radius2) + LogShading(photo, place));
  }
  // Multiplies by a factor that all colours share, vignetting or shading or both.
  static std::array<Exposure, 3> WithFactor(std::array<Exposure, 3> exposure, float log_factor);
  // The photo with this name: its full name as listed, or its file name when only one photo has it.
  std::optional<size_t> Find(const std::string& name) const;

 private:
  float InterpolatedShading(size_t photo, const PicturePlace& place) const;
};

// Writes arrays under "response/". The response must outlive the writer's Commit.
void PutResponse(const Response& response, checkpoint::ArchiveWriter& writer);
// A file without these arrays gives a response of no photos. Throws base::InputError when the arrays' sizes disagree.
Response GetResponse(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file);

}  // namespace skyquilt::brightness
