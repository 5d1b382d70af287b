#include "viewer/protocol/frame.h"

#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "core/base/errors.h"
#include "core/image/depth_code.h"
#include "core/image/image.h"

namespace skyquilt::viewer {
namespace {

constexpr int kMaxSide = 4096;  // pixels of a pass
constexpr int kJpegQuality = 85;
constexpr uint16_t kVersion = 1;
enum Flag : unsigned { kBeforeFlag = 1, kOrthographicFlag = 2, kPhotoFlag = 4 };

template <typename T>
void Put(T value, size_t at, std::string* bytes) {
  for (size_t i = 0; i < sizeof(T); ++i) (*bytes)[at + i] = static_cast<char>(static_cast<uint64_t>(value) >> (8 * i) & 0xFFU);
}

template <typename T>
T Get(std::string_view bytes, size_t at) {
  uint64_t value = 0;
  for (size_t i = 0; i < sizeof(T); ++i) value |= uint64_t{static_cast<unsigned char>(bytes[at + i])} << (8 * i);
  return static_cast<T>(value);
}

double GetDouble(std::string_view bytes, size_t at) {
  const double value = std::bit_cast<double>(Get<uint64_t>(bytes, at));
  if (!std::isfinite(value)) throw std::runtime_error("frame: a number is not finite");
  return value;
}

float GetFloat(std::string_view bytes, size_t at) {
  return std::bit_cast<float>(Get<uint32_t>(bytes, at));
}

image::DepthScale ScaleOf(const FrameHeader& header) {
  return header.orthographic ? image::DepthScale::kLinear : image::DepthScale::kInverse;
}

std::string EncodeColor(const FrameHeader& header, std::span<const uint8_t> rgb) {
  image::Image8 picture;
  picture.width = header.w;
  picture.height = header.h;
  picture.channels = 3;
  picture.data.assign(rgb.begin(), rgb.end());
  if (header.format == ColorFormat::kPng) return image::EncodePng(picture, image::kFastPng);
  const std::vector<uint8_t> jpeg = image::EncodeJpeg(picture, kJpegQuality);
  return {jpeg.begin(), jpeg.end()};
}

std::string Problem(const FrameHeader& header) {
  if (header.width < 1 || header.height < 1 || header.width > kMaxSide || header.height > kMaxSide) return "the size is not 1 to 4096 pixels";
  if (header.x < 0 || header.y < 0 || header.w < 1 || header.h < 1 || header.x + header.w > header.width || header.y + header.h > header.height) {
    return "the rectangle is not inside the picture";
  }
  if (header.passes < 1 || header.passes > 255 || header.pass < 0 || header.pass >= header.passes) return "there is no such pass";
  return "";
}

}  // namespace

std::string EncodeFrame(const FrameHeader& header, std::span<const uint8_t> rgb, std::span<const float> z_m) {
  const std::string problem = Problem(header);
  SKYQUILT_CHECK(problem.empty(), problem);
  const size_t n_pixels = static_cast<size_t>(header.w) * static_cast<size_t>(header.h);
  SKYQUILT_CHECK(rgb.size() == 3 * n_pixels && z_m.size() == n_pixels, "colours and depths do not match the rectangle");
  const std::string color = EncodeColor(header, rgb);
  const std::vector<float> depths = image::HalfDepths(z_m, header.w, header.h, ScaleOf(header));
  const std::optional<image::DepthRange> range = image::RangeOfDepths(depths);
  const std::string depth = range ? image::PackDepths(depths, *range, ScaleOf(header)) : "";
  std::string bytes(kFrameHeaderBytes, '\0');
  bytes.replace(0, 4, "SKYF");
  Put(kVersion, 4, &bytes);
  Put(static_cast<uint16_t>(kFrameHeaderBytes), 6, &bytes);
  Put(header.seq, 8, &bytes);
  Put(header.revision, 12, &bytes);
  Put(static_cast<uint8_t>(header.pass), 16, &bytes);
  Put(static_cast<uint8_t>(header.passes), 17, &bytes);
  Put(static_cast<uint8_t>(header.format), 18, &bytes);
  const unsigned flags = (header.before ? kBeforeFlag : 0U) | (header.orthographic ? kOrthographicFlag : 0U) | (header.photo ? kPhotoFlag : 0U);
  Put(static_cast<uint8_t>(flags), 19, &bytes);
  const int sizes[] = {header.width, header.height, header.x, header.y, header.w, header.h};
  for (size_t i = 0; i < 6; ++i) Put(static_cast<uint16_t>(sizes[i]), 20 + 2 * i, &bytes);
  const Eigen::Vector3d& eye = header.eye_enu;
  const Eigen::Quaterniond& q = header.cam_from_enu;
  const double numbers[] = {eye.x(), eye.y(), eye.z(), q.w(), q.x(), q.y(), q.z(), header.fovy_deg_or_height_m};
  for (size_t i = 0; i < 8; ++i) Put(std::bit_cast<uint64_t>(numbers[i]), 32 + 8 * i, &bytes);
  Put(std::bit_cast<uint32_t>(range ? range->near_m : 0.0F), 96, &bytes);
  Put(std::bit_cast<uint32_t>(range ? range->far_m : 0.0F), 100, &bytes);
  Put(static_cast<uint16_t>(image::HalfOf(header.w)), 104, &bytes);
  Put(static_cast<uint16_t>(image::HalfOf(header.h)), 106, &bytes);
  Put(static_cast<uint32_t>(color.size()), 108, &bytes);
  Put(static_cast<uint32_t>(depth.size()), 112, &bytes);
  return bytes + color + depth;
}

DecodedFrame DecodeFrame(std::string_view bytes) {
  const auto refuse = [](const std::string& why) { throw std::runtime_error("frame: " + why); };
  if (bytes.size() < kFrameHeaderBytes || bytes.substr(0, 4) != "SKYF") refuse("it does not begin with a header");
  if (Get<uint16_t>(bytes, 4) != kVersion || Get<uint16_t>(bytes, 6) != kFrameHeaderBytes) refuse("it is of another version");
  DecodedFrame frame;
  FrameHeader& header = frame.header;
  header.seq = Get<uint32_t>(bytes, 8);
  header.revision = Get<uint32_t>(bytes, 12);
  header.pass = Get<uint8_t>(bytes, 16);
  header.passes = Get<uint8_t>(bytes, 17);
  const auto format = Get<uint8_t>(bytes, 18), flags = Get<uint8_t>(bytes, 19);
  if (format > 1 || flags > (kBeforeFlag | kOrthographicFlag | kPhotoFlag)) refuse("format or flags are not known");
  header.format = static_cast<ColorFormat>(format);
  header.before = (flags & kBeforeFlag) != 0;
  header.orthographic = (flags & kOrthographicFlag) != 0;
  header.photo = (flags & kPhotoFlag) != 0;
  int* const sizes[] = {&header.width, &header.height, &header.x, &header.y, &header.w, &header.h};
  for (size_t i = 0; i < 6; ++i) *sizes[i] = Get<uint16_t>(bytes, 20 + 2 * i);
  if (const std::string problem = Problem(header); !problem.empty()) refuse(problem);
  for (int axis = 0; axis < 3; ++axis) header.eye_enu[axis] = GetDouble(bytes, 32 + 8 * static_cast<size_t>(axis));
  header.cam_from_enu = {GetDouble(bytes, 56), GetDouble(bytes, 64), GetDouble(bytes, 72), GetDouble(bytes, 80)};
  header.fovy_deg_or_height_m = GetDouble(bytes, 88);
  frame.near_m = GetFloat(bytes, 96);
  frame.far_m = GetFloat(bytes, 100);
  frame.depth_width = Get<uint16_t>(bytes, 104);
  frame.depth_height = Get<uint16_t>(bytes, 106);
  const size_t color_bytes = Get<uint32_t>(bytes, 108), depth_bytes = Get<uint32_t>(bytes, 112);
  if (bytes.size() != kFrameHeaderBytes + color_bytes + depth_bytes) refuse("its length is not the one in its header");
  frame.color = bytes.substr(kFrameHeaderBytes, color_bytes);
  if (frame.depth_width != image::HalfOf(header.w) || frame.depth_height != image::HalfOf(header.h)) refuse("the depth does not match the rectangle");
  const size_t n = static_cast<size_t>(frame.depth_width) * static_cast<size_t>(frame.depth_height);
  frame.depth_m.assign(n, std::numeric_limits<float>::quiet_NaN());
  if (depth_bytes == 0) return frame;
  const image::DepthRange range{frame.near_m, frame.far_m};
  try {
    frame.depth_m = image::UnpackDepths(bytes.substr(kFrameHeaderBytes + color_bytes), n, range, ScaleOf(header));
  } catch (const std::runtime_error& error) {
    refuse(error.what());
  }
  return frame;
}

}  // namespace skyquilt::viewer
