// An exact frame as bytes: a header of 128 bytes, little-endian, then colour, then depth. docs/viewer_protocol.md has the table.
//   0 char[4] "SKYF"   4 u16 version, 1   6 u16 header bytes, 128   8 u32 seq   12 u32 scene revision
//   16 u8 pass   17 u8 passes   18 u8 colour format   19 u8 flags (1 before, 2 orthographic, 4 photo)
//   20 u16 width, 22 u16 height of this pass   24 u16 x, 26 u16 y, 28 u16 w, 30 u16 h: the rectangle of this message
//   32 f64[3] eye_enu   56 f64[4] cam_from_enu w, x, y, z   88 f64 vertical field of view in degrees, or view height in metres
//   96 f32 near_m   100 f32 far_m   104 u16 depth width, 106 u16 depth height
//   108 u32 colour bytes   112 u32 depth bytes   116 u32[3] 0
// Depth: raw deflate (RFC 1951) of u16, row-major, of about half the rectangle's width and height, 0 where there is no surface. It is z along the
// optical axis in metres: perspective 1/z = (1/far) + (q - 1) / 65534 (1/near - 1/far), orthographic z = near + (q - 1) / 65534 (far - near).
// Depth pixel (i, j) is the value at colour pixel (2i, 2j).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace skyquilt::viewer {

enum class ColorFormat : uint8_t { kJpeg = 0, kPng = 1 };

struct FrameHeader {
  uint32_t seq = 0, revision = 0;
  int pass = 0, passes = 0;
  ColorFormat format = ColorFormat::kJpeg;
  bool before = false, orthographic = false, photo = false;
  int width = 0, height = 0;
  int x = 0, y = 0, w = 0, h = 0;
  Eigen::Vector3d eye_enu = Eigen::Vector3d::Zero();
  Eigen::Quaterniond cam_from_enu = Eigen::Quaterniond::Identity();
  double fovy_deg_or_height_m = 0.0;
};

constexpr size_t kFrameHeaderBytes = 128;

// rgb: w * h * 3 display values. z_m: w * h, z along the optical axis, NaN where there is no surface. The last pass is PNG, the others JPEG of
// quality 85, as header.format says. near and far are chosen from the depths; depth bytes are 0 when there are none.
std::string EncodeFrame(const FrameHeader& header, std::span<const uint8_t> rgb, std::span<const float> z_m);

// For tests and other clients written in C++. Throws std::runtime_error for bytes that are not a frame.
struct DecodedFrame {
  FrameHeader header;
  float near_m = 0.0F, far_m = 0.0F;
  int depth_width = 0, depth_height = 0;
  std::string color;           // file bytes, JPEG or PNG
  std::vector<float> depth_m;  // z, NaN where there is none
};
DecodedFrame DecodeFrame(std::string_view bytes);

}  // namespace skyquilt::viewer
