#include "tour/export/packed_pictures.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/base/cancel.h"
#include "core/image/image.h"
#include "tour/export/script_data.h"
#include "tour/pictures/jpeg_quality.h"

namespace skyquilt::tour {
namespace {

using Json = nlohmann::json;

constexpr int kLeastPanoramaWidth = 1024;
constexpr int kLosslessPart = 3;  // lossless stills take at most one part of so many of the limit

std::string PictureName(const std::string& stop, const char* file) {
  return "stops/" + stop + "/" + file;
}

std::string JpegOf(const StoredPicture& picture, int quality) {
  const std::vector<uint8_t> jpeg = image::EncodeJpeg(ColorsOf(picture), quality);
  return {jpeg.begin(), jpeg.end()};
}

// Sums what `bytes_of` says of every stop.
int64_t SumOver(std::span<const StopPictures> stops, base::ThreadPool& threads, const std::function<int64_t(const StopPictures&)>& bytes_of) {
  std::vector<int64_t> bytes(stops.size());
  threads.ParallelFor(static_cast<int64_t>(stops.size()), [&](int64_t i, int) {
    base::ThrowIfCancelled();
    bytes[static_cast<size_t>(i)] = bytes_of(stops[static_cast<size_t>(i)]);
  });
  return std::accumulate(bytes.begin(), bytes.end(), int64_t{0});
}

int64_t Size(const std::string& content) {
  return static_cast<int64_t>(content.size());
}

Json Description(const StoredPicture& picture) {
  const bool deep = !picture.depth.empty();
  return {{"width", picture.width},
          {"height", picture.height},
          {"near", picture.range.near_m},
          {"far", picture.range.far_m},
          {"depth_width", deep ? picture.depth_width : 0},
          {"depth_height", deep ? picture.depth_height : 0}};
}

}  // namespace

StoredPicture Shrunk(const StoredPicture& picture, int shrink) {
  if (shrink == 1) return picture;
  StoredPicture small;
  small.width = picture.width / shrink;
  small.height = picture.height / shrink;
  small.png = image::EncodePng(image::Resize(ColorsOf(picture), small.width, small.height), image::kFastPng);
  small.depth_width = image::HalfOf(small.width);
  small.depth_height = image::HalfOf(small.height);
  small.range = picture.range;
  if (picture.depth.empty()) return small;
  const size_t n = static_cast<size_t>(picture.depth_width) * static_cast<size_t>(picture.depth_height);
  const std::vector<float> depths = image::UnpackDepths(picture.depth, n, picture.range, image::DepthScale::kInverse);
  // Value (i, j) belongs to pixel (2i, 2j): every second of each row and column is taken as often as the picture is halved. Means would lie in the
  // air between a roof and the ground.
  std::vector<float> kept;
  for (int j = 0; j < small.depth_height; ++j) {
    for (int i = 0; i < small.depth_width; ++i) {
      const size_t row = static_cast<size_t>(std::min(j * shrink, picture.depth_height - 1));
      const size_t column = static_cast<size_t>(std::min(i * shrink, picture.depth_width - 1));
      kept.push_back(depths[row * static_cast<size_t>(picture.depth_width) + column]);
    }
  }
  small.depth = image::PackDepths(kept, small.range, image::DepthScale::kInverse);
  return small;
}

PicturePlan FitPicturesOfStops(std::span<const StopPictures> stops, int64_t limit_bytes, base::ThreadPool& threads) {
  PicturePlan plan;
  const auto still_script = [](const StopPictures& stop, const char* ending, int64_t bytes) {
    return ScriptBytes(PictureName(stop.stop, (std::string("still.") + ending).c_str()), bytes);
  };
  const auto depth_script = [](const StopPictures& stop, const char* file, const StoredPicture& picture) {
    return picture.depth.empty() ? 0 : ScriptBytes(PictureName(stop.stop, file), Size(picture.depth));
  };
  const int64_t lossless =
      SumOver(stops, threads, [&](const StopPictures& stop) { return still_script(stop, "png", Size(OpenPicture(stop.still).png)); });
  plan.lossless_stills = lossless <= limit_bytes / kLosslessPart;
  for (;; plan.shrink *= 2) {
    const auto bytes_at = [&](int quality) {
      return (plan.lossless_stills ? lossless : 0) + SumOver(stops, threads, [&](const StopPictures& stop) {
               const StoredPicture still = OpenPicture(stop.still);
               int64_t bytes = depth_script(stop, "still.depth", still);
               if (!plan.lossless_stills) bytes += still_script(stop, "jpg", Size(JpegOf(still, quality)));
               const StoredPicture panorama = Shrunk(OpenPicture(stop.panorama), plan.shrink);
               bytes += ScriptBytes(PictureName(stop.stop, "panorama.jpg"), Size(JpegOf(panorama, quality)));
               return bytes + depth_script(stop, "panorama.depth", panorama);
             });
    };
    const JpegFit fit = FitQuality(bytes_at, limit_bytes);
    plan.quality = fit.quality;
    plan.bytes = fit.bytes;
    plan.fits = fit.fits;
    if (fit.fits || stops.empty()) return plan;
    const int width = OpenPicture(stops.front().panorama).width / plan.shrink;
    if (width / 2 < kLeastPanoramaWidth || width % 4 != 0) return plan;
  }
}

Json WritePicturesOfStops(std::span<const StopPictures> stops, const PicturePlan& plan, const std::filesystem::path& folder,
                          const std::function<void(int64_t bytes)>& on_bytes) {
  Json list = Json::object();
  for (const StopPictures& stop : stops) {
    base::ThrowIfCancelled();
    const auto write = [&](const char* file, const std::string& content) { on_bytes(WriteScript(folder, PictureName(stop.stop, file), content)); };
    const StoredPicture still = OpenPicture(stop.still);
    if (plan.lossless_stills) {
      write("still.png", still.png);
    } else {
      write("still.jpg", JpegOf(still, plan.quality));
    }
    if (!still.depth.empty()) write("still.depth", still.depth);
    const StoredPicture panorama = Shrunk(OpenPicture(stop.panorama), plan.shrink);
    write("panorama.jpg", JpegOf(panorama, plan.quality));
    if (!panorama.depth.empty()) write("panorama.depth", panorama.depth);
    list[stop.stop] = {{"still", Description(still)}, {"panorama", Description(panorama)}};
    list[stop.stop]["still"]["image"] = plan.lossless_stills ? "png" : "jpg";
  }
  return list;
}

}  // namespace skyquilt::tour
