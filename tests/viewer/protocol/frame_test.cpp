#include "viewer/protocol/frame.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "core/image/image.h"

namespace skyquilt::viewer {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

FrameHeader HeaderOf(int width, int height) {
  FrameHeader header;
  header.seq = 0xFFFFFFFE;
  header.revision = 12;
  header.pass = 2;
  header.passes = 3;
  header.format = ColorFormat::kPng;
  header.width = header.w = width;
  header.height = header.h = height;
  header.eye_enu = {1e6 + 0.125, -2.5, 300};
  header.cam_from_enu = Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5);
  header.fovy_deg_or_height_m = 47.25;
  return header;
}

std::vector<uint8_t> Colors(const FrameHeader& header) {
  std::vector<uint8_t> rgb(3 * static_cast<size_t>(header.w) * static_cast<size_t>(header.h));
  for (size_t i = 0; i < rgb.size(); ++i) rgb[i] = static_cast<uint8_t>(i * 7 + i / 50);
  return rgb;
}

image::Image8 Decoded(const std::string& file) {
  return image::DecodeRgb8({reinterpret_cast<const uint8_t*>(file.data()), file.size()});
}

TEST(Frames, KeepHeaderAndColours) {
  FrameHeader header = HeaderOf(21, 13);
  const std::vector<uint8_t> rgb = Colors(header);
  const std::string bytes = EncodeFrame(header, rgb, std::vector<float>(21 * 13, 50.0F));
  const DecodedFrame frame = DecodeFrame(bytes);
  EXPECT_EQ(frame.header.seq, 0xFFFFFFFEU);
  EXPECT_EQ(frame.header.revision, 12U);
  EXPECT_EQ(frame.header.pass, 2);
  EXPECT_EQ(frame.header.passes, 3);
  EXPECT_EQ(frame.header.width, 21);
  EXPECT_EQ(frame.header.height, 13);
  EXPECT_EQ(frame.header.eye_enu, header.eye_enu);
  EXPECT_EQ(frame.header.cam_from_enu.coeffs(), header.cam_from_enu.coeffs());
  EXPECT_EQ(frame.header.fovy_deg_or_height_m, 47.25);
  EXPECT_FALSE(frame.header.before || frame.header.orthographic || frame.header.photo);
  EXPECT_EQ(Decoded(frame.color).data, rgb) << "the last pass is lossless";
  EXPECT_EQ(frame.depth_width, 11);
  EXPECT_EQ(frame.depth_height, 7);

  header.format = ColorFormat::kJpeg;
  header.before = header.photo = true;
  const DecodedFrame preview = DecodeFrame(EncodeFrame(header, rgb, std::vector<float>(21 * 13, 50.0F)));
  EXPECT_TRUE(preview.header.before && preview.header.photo && !preview.header.orthographic);
  EXPECT_EQ(preview.color.substr(0, 2), "\xFF\xD8");
  EXPECT_EQ(Decoded(preview.color).width, 21);
}

// Offsets and byte order are a contract with programs in other languages.
TEST(Frames, HaveTheDocumentedLayout) {
  FrameHeader header = HeaderOf(32, 20);
  header.x = 4;
  header.y = 6;
  header.w = 17;
  header.h = 9;
  header.orthographic = true;
  const std::string bytes = EncodeFrame(header, Colors(header), std::vector<float>(17 * 9, -1.5F));
  const auto byte = [&](size_t at) { return static_cast<unsigned char>(bytes[at]); };
  EXPECT_EQ(bytes.substr(0, 4), "SKYF");
  const unsigned char expected[] = {1, 0, 128, 0, 0xFE, 0xFF, 0xFF, 0xFF, 12, 0, 0, 0, 2, 3, 1, 2, 32, 0, 20, 0, 4, 0, 6, 0, 17, 0, 9, 0};
  for (size_t i = 0; i < std::size(expected); ++i) EXPECT_EQ(byte(4 + i), expected[i]) << 4 + i;
  // 47.25 = 0x4047A00000000000, -1.5F = 0xBFC00000.
  EXPECT_EQ(byte(95), 0x40);
  EXPECT_EQ(byte(94), 0x47);
  EXPECT_EQ(byte(93), 0xA0);
  EXPECT_EQ(byte(99), 0xBF);
  EXPECT_EQ(byte(98), 0xC0);
  EXPECT_EQ(byte(104), 9);
  EXPECT_EQ(byte(106), 5);
  for (size_t i = 116; i < 128; ++i) EXPECT_EQ(byte(i), 0);
  EXPECT_EQ(DecodeFrame(bytes).header.x, 4);
  EXPECT_EQ(DecodeFrame(bytes).header.h, 9);
}

TEST(Frames, DepthPixelsAreEverySecondColourPixel) {
  const FrameHeader header = HeaderOf(5, 3);
  std::vector<float> z(15);
  for (size_t i = 0; i < z.size(); ++i) z[i] = 10.0F + static_cast<float>(i);
  const DecodedFrame frame = DecodeFrame(EncodeFrame(header, Colors(header), z));
  ASSERT_EQ(frame.depth_m.size(), 6U);
  const size_t from[] = {0, 2, 4, 10, 12, 14};
  for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(frame.depth_m[i], z[from[i]], 1e-3);
  EXPECT_EQ(frame.near_m, 10.0F);
  EXPECT_EQ(frame.far_m, 24.0F);
}

TEST(Frames, WithoutASurfaceHaveNoDepth) {
  const FrameHeader header = HeaderOf(16, 16);
  std::vector<float> z(256, kNone);
  z[0] = -5.0F;  // behind the eye
  z[2] = std::numeric_limits<float>::infinity();
  const std::string bytes = EncodeFrame(header, Colors(header), z);
  EXPECT_EQ(bytes.substr(112, 4), std::string(4, '\0'));
  for (const float depth : DecodeFrame(bytes).depth_m) EXPECT_TRUE(std::isnan(depth));
}

RC_GTEST_PROP(Frames, DepthsAreWithinHalfAStep, ()) {
  FrameHeader header = HeaderOf(16, 18);
  header.orthographic = *rc::gen::arbitrary<bool>();
  const double near_m = std::exp(*rc::gen::inRange(-30, 60) * 0.1), range = std::exp(*rc::gen::inRange(-60, 90) * 0.1);
  std::vector<float> z(16 * 18, kNone);
  for (float& depth : z) {
    const int share = *rc::gen::inRange(-200, 1001);
    if (share >= 0) depth = static_cast<float>(near_m + range * share / 1000.0 - (header.orthographic ? 100.0 : 0.0));
  }
  const DecodedFrame frame = DecodeFrame(EncodeFrame(header, Colors(header), z));
  for (size_t row = 0; row < 9; ++row) {
    for (size_t column = 0; column < 8; ++column) {
      const float before = z[2 * row * 16 + 2 * column], after = frame.depth_m[row * 8 + column];
      RC_ASSERT(std::isnan(before) == std::isnan(after));
      if (std::isnan(before)) continue;
      const auto b = static_cast<double>(before), a = static_cast<double>(after);
      const auto low = static_cast<double>(frame.near_m), high = static_cast<double>(frame.far_m);
      // Rounding to float comes on top.
      if (header.orthographic) {
        RC_ASSERT(std::abs(a - b) <= 0.5001 * (high - low) / 65534.0 + 1e-6 * std::abs(b));
      } else {
        RC_ASSERT(std::abs(1.0 / a - 1.0 / b) <= 0.5001 * (1.0 / low - 1.0 / high) / 65534.0 + 1e-6 / b);
      }
    }
  }
}

TEST(Frames, OfOtherShapesAreOurOwnMistake) {
  FrameHeader header = HeaderOf(16, 16);
  const std::vector<uint8_t> rgb = Colors(header);
  EXPECT_THROW(EncodeFrame(header, rgb, std::vector<float>(255)), std::logic_error);
  header.x = 1;
  EXPECT_THROW(EncodeFrame(header, rgb, std::vector<float>(256)), std::logic_error);
  header = HeaderOf(16, 16);
  header.pass = 3;
  EXPECT_THROW(EncodeFrame(header, rgb, std::vector<float>(256)), std::logic_error);
}

TEST(Frames, DamagedOnesAreRefused) {
  const FrameHeader header = HeaderOf(16, 16);
  std::vector<float> z(256, 20.0F);
  for (size_t i = 0; i < z.size(); ++i) z[i] += static_cast<float>(i % 37);
  const std::string bytes = EncodeFrame(header, Colors(header), z);
  for (const size_t length : {size_t{0}, size_t{4}, size_t{127}, size_t{128}, bytes.size() - 1}) {
    EXPECT_THROW(DecodeFrame(std::string_view(bytes).substr(0, length)), std::runtime_error) << length;
  }
  EXPECT_THROW(DecodeFrame(bytes + "x"), std::runtime_error);
  const auto changed = [&](size_t at, char value) {
    std::string copy = bytes;
    copy[at] = value;
    return copy;
  };
  for (const auto& [at, value] : std::initializer_list<std::pair<size_t, char>>{
           {0, 'X'}, {4, 2}, {16, 3}, {18, 2}, {19, 8}, {20, 15}, {21, 64}, {24, 1}, {99, -1}, {104, 9}, {108, 0}}) {
    EXPECT_THROW(DecodeFrame(changed(at, value)), std::runtime_error) << at;
  }
  std::string not_a_number = bytes;
  for (size_t i = 32; i < 40; ++i) not_a_number[i] = '\xFF';
  EXPECT_THROW(DecodeFrame(not_a_number), std::runtime_error);
  EXPECT_THROW(DecodeFrame(changed(bytes.size() - 1, static_cast<char>(bytes.back() ^ 0x55))), std::runtime_error);
}

}  // namespace
}  // namespace skyquilt::viewer
