#include "core/image/normal_image.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>

#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::image {
namespace {

bool HasNormal(const float* n) {
  return std::isfinite(n[0]) && std::isfinite(n[1]) && std::isfinite(n[2]);
}

}  // namespace

void SaveNormals(const ImageF& normals, const std::filesystem::path& file) {
  SKYQUILT_CHECK(normals.channels == 3 && !normals.Empty(), "normals have three channels");
  cv::Mat bgr(normals.height, normals.width, CV_16UC3, cv::Scalar(0, 0, 0));
  for (int y = 0; y < normals.height; ++y) {
    for (int x = 0; x < normals.width; ++x) {
      const float* n = normals.At(x, y);
      if (!HasNormal(n)) continue;
      auto& stored = bgr.at<cv::Vec3w>(y, x);
      for (int c = 0; c < 3; ++c) stored[2 - c] = static_cast<uint16_t>(std::lround(32768.0F + 32767.0F * std::clamp(n[c], -1.0F, 1.0F)));
    }
  }
  std::vector<uint8_t> bytes;
  SKYQUILT_CHECK(cv::imencode(".png", bgr, bytes, {cv::IMWRITE_PNG_COMPRESSION, 3}), "OpenCV could not encode normals");
  base::WriteFileAtomically(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

ImageF LoadNormals(const std::filesystem::path& file) {
  const cv::Mat bgr = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  if (bgr.empty() || bgr.type() != CV_16UC3) {
    throw base::InputError(file, "is not a picture of normals (PNG, RGB, 16 bits per channel)", "use a file of `skyquilt render --normals`");
  }
  ImageF normals(bgr.cols, bgr.rows, 3, std::numeric_limits<float>::quiet_NaN());
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      const auto& stored = bgr.at<cv::Vec3w>(y, x);
      if (stored == cv::Vec3w(0, 0, 0)) continue;
      float n[3], length2 = 0.0F;
      for (int c = 0; c < 3; ++c) {
        n[c] = (static_cast<float>(stored[2 - c]) - 32768.0F) / 32767.0F;
        length2 += n[c] * n[c];
      }
      if (length2 < 0.25F) continue;
      for (int c = 0; c < 3; ++c) normals.At(x, y)[c] = n[c] / std::sqrt(length2);
    }
  }
  return normals;
}

Image8 ShowNormals(const ImageF& normals) {
  SKYQUILT_CHECK(normals.channels == 3, "normals have three channels");
  Image8 shown(normals.width, normals.height, 3, 0);
  for (size_t i = 0; i + 2 < normals.data.size(); i += 3) {
    if (!HasNormal(normals.data.data() + i)) continue;
    for (size_t c = 0; c < 3; ++c)
      shown.data[i + c] = static_cast<uint8_t>(std::lround(127.5F + 127.5F * std::clamp(normals.data[i + c], -1.0F, 1.0F)));
  }
  return shown;
}

}  // namespace skyquilt::image
