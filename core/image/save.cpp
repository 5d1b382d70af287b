#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/image/image.h"

namespace skyquilt::image {
namespace {

template <typename T>
cv::Mat Wrap(const BasicImage<T>& image, int depth) {
  SKYQUILT_CHECK(image.width > 0 && image.height > 0, "an empty image cannot be encoded");
  SKYQUILT_CHECK(image.data.size() == static_cast<size_t>(image.width) * static_cast<size_t>(image.height) * static_cast<size_t>(image.channels),
                 "image data does not match its shape");
  return {image.height, image.width, CV_MAKETYPE(depth, image.channels), const_cast<T*>(image.data.data())};
}

cv::Mat ToBgr(const Image8& image) {
  SKYQUILT_CHECK(image.channels == 1 || image.channels == 3,
                 "only grey and RGB images are encoded, not " + std::to_string(image.channels) + " channels");
  const cv::Mat pixels = Wrap(image, CV_8U);
  if (image.channels == 1) return pixels;
  cv::Mat bgr;
  cv::cvtColor(pixels, bgr, cv::COLOR_RGB2BGR);
  return bgr;
}

std::vector<uint8_t> Encode(const char* extension, const cv::Mat& pixels, const std::vector<int>& parameters) {
  std::vector<uint8_t> bytes;
  SKYQUILT_CHECK(cv::imencode(extension, pixels, bytes, parameters), "OpenCV could not encode this image");
  return bytes;
}

void Write(const std::vector<uint8_t>& bytes, const std::filesystem::path& file) {
  base::WriteFileAtomically(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

void SaveFloatTiff(const ImageF& image, const std::filesystem::path& file) {
  SKYQUILT_CHECK(image.channels == 1, "a float TIFF holds one channel, not " + std::to_string(image.channels));
  constexpr int kDeflate = 8;  // TIFF tag values of COMPRESSION_ADOBE_DEFLATE and PREDICTOR_NONE
  constexpr int kNoPredictor = 1;
  constexpr int kPredictorTag = 317;
  Write(Encode(".tiff", Wrap(image, CV_32F), {cv::IMWRITE_TIFF_COMPRESSION, kDeflate, kPredictorTag, kNoPredictor}), file);
}

void SavePng(const Image8& image, const std::filesystem::path& file) {
  Write(Encode(".png", ToBgr(image), {cv::IMWRITE_PNG_COMPRESSION, 3}), file);
}

std::vector<uint8_t> EncodeJpeg(const Image8& image, int quality) {
  return Encode(".jpg", ToBgr(image), {cv::IMWRITE_JPEG_QUALITY, quality});
}

void SaveJpeg(const Image8& image, const std::filesystem::path& file, int quality) {
  Write(EncodeJpeg(image, quality), file);
}

std::string EncodePng(const Image8& image, int level) {
  const cv::Mat pixels = Wrap(image, CV_8U);
  SKYQUILT_CHECK(image.channels == 1 || image.channels == 3 || image.channels == 4,
                 "PNG has grey, RGB or RGBA pixels, not " + std::to_string(image.channels) + " channels");
  SKYQUILT_CHECK(level >= kFastPng && level <= 9, "PNG has no compression level " + std::to_string(level));
  cv::Mat ordered;
  if (image.channels == 1) {
    ordered = pixels;
  } else {
    cv::cvtColor(pixels, ordered, image.channels == 3 ? cv::COLOR_RGB2BGR : cv::COLOR_RGBA2BGRA);
  }
  // Without a level, OpenCV takes the fastest filter and strategy.
  std::vector<int> parameters;
  if (level != kFastPng) parameters = {cv::IMWRITE_PNG_COMPRESSION, level};
  const std::vector<uint8_t> bytes = Encode(".png", ordered, parameters);
  return {bytes.begin(), bytes.end()};
}

}  // namespace skyquilt::image
