#include "core/brightness/response.h"

#include <algorithm>
#include <cmath>

#include "core/base/errors.h"

namespace skyquilt::brightness {
namespace {

constexpr const char* kReference = "reference_exposure";
constexpr const char* kExif = "response/exif_gain";
constexpr const char* kGain = "response/log_gain";
constexpr const char* kCamera = "response/camera";
constexpr const char* kVignetting = "response/vignetting";
constexpr const char* kNames = "response/names";
constexpr const char* kShading = "response/shading";
constexpr const char* kShadingSigma = "shading_sigma";

}  // namespace

Response Response::Neutral(size_t photos, size_t cameras) {
  Response response;
  response.exif_gain.assign(photos, 1.0F);
  response.log_gain.assign(3 * photos, 0.0F);
  response.camera.assign(photos, 0);
  response.vignetting.assign(3 * cameras, 0.0F);
  return response;
}

float Response::LogVignetting(size_t photo, float radius2) const {
  const float* f = vignetting.data() + 3 * static_cast<size_t>(camera[photo]);
  return radius2 * (f[0] + radius2 * (f[1] + radius2 * f[2]));
}

std::array<float, 3> Response::LogGain(size_t photo, float radius2) const {
  const float common = (exif_gain[photo] == 1.0F ? 0.0F : std::log(exif_gain[photo])) + LogVignetting(photo, radius2);
  std::array<float, 3> sum{};
  for (size_t c = 0; c < 3; ++c) sum[c] = common + log_gain[3 * photo + c];
  return sum;
}

std::array<Exposure, 3> Response::ExposureOf(size_t photo) const {
  const std::array<float, 3> log = LogGain(photo);
  return {Exposure::FromLogGain(log[0]), Exposure::FromLogGain(log[1]), Exposure::FromLogGain(log[2])};
}

float Response::InterpolatedShading(size_t photo, const PicturePlace& place) const {
  const KnotWeights at = KnotsAt(shading_grid, place);
  const float* const knots = shading.data() + photo * shading_grid.knots();
  float sum = 0.0F;
  for (size_t i = 0; i < at.knot.size(); ++i) sum += at.weight[i] * knots[at.knot[i]];
  return sum;
}

void Response::AddShading(const ShadingGrid& grid, float sigma) {
  shading_grid = grid;
  shading_sigma = sigma;
  shading.assign(photos() * grid.knots(), 0.0F);
}

std::array<Exposure, 3> Response::WithFactor(std::array<Exposure, 3> exposure, float log_factor) {
  if (log_factor == 0.0F) return exposure;
  const Exposure factor = Exposure::FromLogGain(log_factor);
  for (Exposure& one : exposure) one = {one.log_gain + log_factor, one.gain * factor.gain, one.root * factor.root};
  return exposure;
}

std::optional<size_t> Response::Find(const std::string& name) const {
  std::optional<size_t> by_file_name;
  bool ambiguous = false;
  size_t photo = 0;
  for (auto begin = names.begin(); begin != names.end(); ++photo) {
    const auto end = std::find(begin, names.end(), static_cast<uint8_t>('\n'));
    const std::string listed(begin, end);
    if (listed == name) return photo;
    if (listed.substr(listed.find_last_of('/') + 1) == name) {
      ambiguous = by_file_name.has_value();
      by_file_name = photo;
    }
    begin = end == names.end() ? end : end + 1;
  }
  return ambiguous ? std::nullopt : by_file_name;
}

void PutResponse(const Response& response, checkpoint::ArchiveWriter& writer) {
  const auto photos = static_cast<int64_t>(response.photos());
  writer.SetAttribute(kReference, response.reference_exposure);
  writer.Put(kExif, response.exif_gain);
  writer.Put(kGain, response.log_gain, {photos, 3});
  writer.Put(kCamera, response.camera);
  writer.Put(kVignetting, response.vignetting, {static_cast<int64_t>(response.vignetting.size() / 3), 3});
  writer.Put(kNames, response.names);
  if (!response.shading_grid.On()) return;
  writer.Put(kShading, response.shading, {photos, response.shading_grid.rows, response.shading_grid.columns});
  writer.SetAttribute(kShadingSigma, static_cast<double>(response.shading_sigma));
}

Response GetResponse(const checkpoint::ArchiveReader& reader, const std::filesystem::path& file) {
  Response response;
  response.reference_exposure = reader.DoubleAttribute(kReference);
  if (!reader.Has(kExif)) return response;
  response.exif_gain = reader.Floats(kExif);
  response.log_gain = reader.Floats(kGain);
  response.camera = reader.Ints(kCamera);
  response.vignetting = reader.Floats(kVignetting);
  response.names = reader.Bytes(kNames);
  bool shading_fits = true;
  if (reader.Has(kShading)) {
    const std::vector<int64_t> shape = reader.Shape(kShading);
    shading_fits = shape.size() == 3 && shape[0] == static_cast<int64_t>(response.photos()) && shape[1] >= 2 && shape[2] >= 2;
    if (shading_fits) {
      response.shading_grid = {static_cast<int>(shape[2]), static_cast<int>(shape[1])};
      response.shading = reader.Floats(kShading);
      response.shading_sigma = static_cast<float>(reader.DoubleAttribute(kShadingSigma));
    }
  }
  const auto cameras = static_cast<int64_t>(response.vignetting.size() / 3);
  const bool fits = shading_fits && response.log_gain.size() == 3 * response.photos() && response.camera.size() == response.photos() &&
                    std::all_of(response.camera.begin(), response.camera.end(), [&](int64_t c) { return c >= 0 && c < cameras; });
  if (!fits) throw base::InputError(file, "its arrays response/... have sizes that disagree with each other", "Train it again with --restart");
  return response;
}

}  // namespace skyquilt::brightness
