#include "core/image/encode.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base/errors.h"

namespace skyquilt::image {

std::string EncodePng(const Image8& image, int level) {
  SKYQUILT_CHECK(image.width > 0 && image.height > 0, "an empty image cannot be encoded");
  SKYQUILT_CHECK(image.channels == 1 || image.channels == 3 || image.channels == 4,
                 "PNG has grey, RGB or RGBA pixels, not " + std::to_string(image.channels) + " channels");
  SKYQUILT_CHECK(image.data.size() == static_cast<size_t>(image.width) * static_cast<size_t>(image.height) * static_cast<size_t>(image.channels),
                 "image data does not match its shape");
  SKYQUILT_CHECK(level >= kFastPng && level <= 9, "PNG has no compression level " + std::to_string(level));
  const cv::Mat pixels(image.height, image.width, CV_MAKETYPE(CV_8U, image.channels), const_cast<uint8_t*>(image.data.data()));
  cv::Mat ordered;
  if (image.channels == 1) {
    ordered = pixels;
  } else {
    cv::cvtColor(pixels, ordered, image.channels == 3 ? cv::COLOR_RGB2BGR : cv::COLOR_RGBA2BGRA);
  }
  // Without a level, OpenCV takes the fastest filter and strategy.
  std::vector<int> parameters;
  if (level != kFastPng) parameters = {cv::IMWRITE_PNG_COMPRESSION, level};
  std::vector<uint8_t> bytes;
  SKYQUILT_CHECK(cv::imencode(".png", ordered, bytes, parameters), "OpenCV could not encode this image");
  return {bytes.begin(), bytes.end()};
}

}  // namespace skyquilt::image
