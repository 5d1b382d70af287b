#include "viewer/protocol/messages.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/support/error_of.h"
#include "tests/viewer/protocol/sample_messages.h"

namespace skyquilt::viewer {
namespace {

template <typename T>
T Parsed(const std::string& text) {
  const ClientMessage message = ParseClientMessage(text);
  EXPECT_TRUE(std::holds_alternative<T>(message)) << text;
  return std::get<T>(message);
}

std::string Refusal(const std::string& text) {
  return ErrorOf<BadMessage>([&] { ParseClientMessage(text); });
}

TEST(ClientMessages, KeepWhatTheTextSays) {
  EXPECT_EQ(Parsed<Hello>(R"({"type":"hello","version":1})").version, 1);
  const auto view = Parsed<ViewRequest>(kViewSample);
  EXPECT_EQ(view.seq, 7U);
  EXPECT_EQ(view.project, Which::kMain);
  EXPECT_EQ(view.eye_enu, Eigen::Vector3d(1.5, -2, 300));
  EXPECT_TRUE(view.cam_from_enu.coeffs().isApprox(Eigen::Quaterniond(0, 1, 0, 0).coeffs()));
  EXPECT_FALSE(view.orthographic);
  EXPECT_EQ(view.fovy_deg, 45.0);
  EXPECT_EQ(view.width, 1000);
  EXPECT_EQ(view.height, 563);
  EXPECT_EQ(view.photo, -1);
  const auto map = Parsed<ViewRequest>(SampleMessages()[2]);
  EXPECT_EQ(map.project, Which::kBefore);
  EXPECT_TRUE(map.orthographic);
  EXPECT_EQ(map.view_height_m, 80.5);
  EXPECT_TRUE(map.cam_from_enu.coeffs().isApprox(Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5).coeffs()));
  const auto photo = Parsed<ViewRequest>(R"({"type":"view","seq":4294967295,"photo":12,"w":640})");
  EXPECT_EQ(photo.seq, 4294967295U);
  EXPECT_EQ(photo.photo, 12);
  EXPECT_EQ(photo.width, 640);
  EXPECT_EQ(Parsed<StopView>(R"({"type":"stop","seq":7})").seq, 7U);
  EXPECT_EQ(Parsed<FrameAck>(R"({"type":"ack","seq":7,"pass":2})").pass, 2);
  const auto pick = Parsed<PickRequest>(SampleMessages()[6]);
  EXPECT_EQ(pick.id, 3U);
  EXPECT_TRUE(pick.direction_enu.isApprox(Eigen::Vector3d(0, 0.6, -0.8)));
  EXPECT_EQ(pick.pixel_pitch, 0.001);
  EXPECT_EQ(Parsed<PhotosAtRequest>(R"({"type":"photos_at","id":4,"point":[10,20,1.25]})").point_enu, Eigen::Vector3d(10, 20, 1.25));
  const auto profile = Parsed<ProfileRequest>(SampleMessages()[8]);
  EXPECT_EQ(profile.to_enu, Eigen::Vector2d(30, 40));
  EXPECT_EQ(profile.samples, 256);
  EXPECT_EQ(profile.project, Which::kBefore);
  const auto volume = Parsed<VolumeRequest>(kVolumeSample);
  ASSERT_EQ(volume.polygon_enu.size(), 3U);
  EXPECT_EQ(volume.polygon_enu[2], Eigen::Vector2d(10, 8.5));
  EXPECT_EQ(volume.base, VolumeBase::kHeight);
  EXPECT_EQ(volume.base_height_m, -3.25);
  const std::pair<const char*, VolumeBase> bases[] = {
      {"plane", VolumeBase::kPlane}, {"lowest", VolumeBase::kLowest}, {"height", VolumeBase::kHeight}, {"before", VolumeBase::kBefore}};
  for (const auto& [name, base] : bases)
    EXPECT_EQ(Parsed<VolumeRequest>(With(kVolumeSample, "\"height\"", "\"" + std::string(name) + "\"")).base, base);
  EXPECT_EQ(Parsed<TrustMapRequest>(R"({"type":"trust_map","id":11})").id, 11U);
  EXPECT_EQ(Parsed<ErrorMapRequest>(R"({"type":"error_map","id":10})").id, 10U);
  EXPECT_EQ(Parsed<CancelRequest>(R"({"type":"cancel","id":11})").id, 11U);
}

TEST(ClientMessages, NormaliseRotations) {
  const auto view = Parsed<ViewRequest>(With(kViewSample, "[0,1,0,0]", "[0,1.0009,0,0]"));
  EXPECT_NEAR(view.cam_from_enu.norm(), 1.0, 1e-15);
  EXPECT_NE(Refusal(With(kViewSample, "[0,1,0,0]", "[0,1.002,0,0]")), "");
  EXPECT_NE(Refusal(With(kViewSample, "[0,1,0,0]", "[0,0.998,0,0]")), "");
  EXPECT_NE(Refusal(With(kViewSample, "[0,1,0,0]", "[0,0,0,0]")), "");
}

TEST(ClientMessages, RefuseWhatIsNotAllowed) {
  const struct {
    std::string text, part;
  } cases[] = {
      {"", "not valid JSON"},
      {"null", "object"},
      {"[1]", "object"},
      {R"({"type":"hello","version":1)", "not valid JSON"},
      {R"({"type":"hello","version":1} {})", "not valid JSON"},
      {"{\"type\":\"hello\",\"version\":1,\"\xFF\":1}", "not valid JSON"},
      {R"({"version":1})", "type: must be a text"},
      {R"({"type":5})", "type: must be a text"},
      {R"({"type":"helo","version":1})", "\"helo\" is not known"},
      {R"({"type":"hello"})", "hello.version"},
      {R"({"type":"hello","version":1.0})", "whole number"},
      {R"({"type":"hello","version":"1"})", "whole number"},
      {R"({"type":"hello","version":1,"more":2})", "\"more\" is not allowed"},
      {R"({"type":"hello","version":1,"version":1})", "\"version\" occurs twice"},
      {R"({"type":"stop","seq":-1})", "0 to 4294967295"},
      {R"({"type":"stop","seq":4294967296})", "0 to 4294967295"},
      {R"({"type":"stop","seq":18446744073709551615})", "0 to 4294967295"},
      {R"({"type":"stop","seq":99999999999999999999999})", "0 to 4294967295"},
      {R"({"type":"stop","seq":[[[[1]]]]})", "levels of brackets"},
      {R"({"type":"ack","seq":1,"pass":256})", "ack.pass"},
      {With(kViewSample, "300", "1e999"), "not valid JSON"},
      {With(kViewSample, "300", "1.1e7"), "view.eye"},
      {With(kViewSample, "300", "null"), "view.eye"},
      {With(kViewSample, "300", "3,4"), "view.eye"},
      {With(kViewSample, "[1.5,-2,300]", "{\"x\":1}"), "view.eye"},
      {With(kViewSample, "45", "0.5"), "view.fovy_deg: must be a number from 1 to 150"},
      {With(kViewSample, "45", "true"), "view.fovy_deg"},
      {With(kViewSample, "\"fovy_deg\":45", "\"fovy_deg\":45,\"height_m\":10"), "height_m"},
      {With(kViewSample, "perspective", "orthographic"), "view.height_m"},
      {With(kViewSample, "perspective", "fisheye"), "perspective, orthographic"},
      {With(kViewSample, "1000", "2049"), "view.w: must be a whole number from 16 to 2048"},
      {With(kViewSample, "563", "15"), "view.h"},
      {With(kViewSample, "\"main\"", "\"after\""), "main, before"},
      {R"({"type":"view","seq":1,"photo":-1,"w":640})", "view.photo"},
      {R"({"type":"view","seq":1,"photo":1,"w":640,"h":480})", "\"h\" is not allowed"},
      {R"({"type":"view","seq":1,"photo":1,"w":640,"project":"main"})", "\"project\" is not allowed"},
      {With(SampleMessages()[6], "[0,3,-4]", "[0,0,0]"), "pick.direction"},
      {With(SampleMessages()[6], "0.001", "1.5"), "pick.pixel_pitch"},
      {With(SampleMessages()[6], "\"pixel_width_m\":0", "\"pixel_width_m\":-1"), "pick.pixel_width_m"},
      {With(SampleMessages()[8], "256", "1025"), "profile.samples"},
      {With(SampleMessages()[8], "[30,40]", "[0,0]"), "profile.to"},
      {With(kVolumeSample, ",[10,8.5]", ""), "volume.polygon"},
      {With(kVolumeSample, "[10,0]", "[10,0,0]"), "volume.polygon"},
      {With(kVolumeSample, "[10,8.5]", "[5,0]"), "volume.polygon"},
      {With(kVolumeSample, ",\"base_height_m\":-3.25", ""), "volume.base_height_m"},
      {With(kVolumeSample, "\"height\"", "\"highest\""), "plane, lowest, height, before"},
  };
  for (const auto& [text, part] : cases) EXPECT_NE(Refusal(text).find(part), std::string::npos) << text << "\n" << Refusal(text);
}

TEST(ClientMessages, LimitTheirLength) {
  const std::string text = R"({"type":"hello","version":1})";
  EXPECT_EQ(Refusal(text + std::string(kMaxMessageBytes - text.size(), ' ')), "");
  EXPECT_NE(Refusal(text + std::string(kMaxMessageBytes + 1 - text.size(), ' ')).find("4096 bytes"), std::string::npos);
  std::string corners;
  for (int i = 0; i < kMaxPolygonCorners; ++i) {
    corners += (i > 0 ? ",[" : "[") + std::to_string(1e6 * std::cos(0.09 * i)) + "," + std::to_string(1e6 * std::sin(0.09 * i)) + "]";
  }
  const auto with_corners = [](const std::string& list) { return With(kVolumeSample, "[0,0],[10,0],[10,8.5]", list); };
  EXPECT_EQ(Parsed<VolumeRequest>(with_corners(corners)).polygon_enu.size(), 64U);
  EXPECT_NE(Refusal(with_corners(corners + ",[-5,-5]")).find("3 to 64"), std::string::npos);
}

TEST(ClientMessages, RefusalsRepeatLittleAndOnlyPlainText) {
  const std::string refusal = Refusal(R"({"type":"<script>\u0007\u00e4)" + std::string(3000, 'x') + "\"}");
  EXPECT_LT(refusal.size(), 100U);
  for (const char c : refusal) EXPECT_TRUE(c >= 0x20 && c < 0x7F);
  EXPECT_LT(Refusal(R"({"type":"hello","version":1,")" + std::string(3000, 'x') + "\":1}").size(), 120U);
}

RC_GTEST_PROP(ClientMessages, AnyBytesAreReadOrRefused, (const std::string& bytes)) {
  try {
    ParseClientMessage(bytes);
  } catch (const BadMessage&) {
  }
}

// A member less, a member twice, a bracket more, a byte changed.
RC_GTEST_PROP(ClientMessages, DamagedTextsAreReadOrRefused, ()) {
  std::string text = *rc::gen::elementOf(SampleMessages());
  const int changes = *rc::gen::inRange(1, 4);
  for (int i = 0; i < changes; ++i) {
    const auto at = *rc::gen::inRange<size_t>(0, text.size());
    const std::string piece = *rc::gen::elementOf(std::vector<std::string>{"", "[", "]", "{", "}", "\"", ",", ":", "-", "1e308", "9e999", "null",
                                                                           "\\u0000", "18446744073709551616", "\xC3", "NaN"});
    text.replace(at, *rc::gen::inRange<size_t>(0, 12), piece);
  }
  try {
    ParseClientMessage(text);
  } catch (const BadMessage&) {
  }
}

RC_GTEST_PROP(ClientMessages, CoordinatesSurviveExactly, ()) {
  const auto x = *rc::gen::map(rc::gen::inRange(-1'000'000'000, 1'000'000'000), [](int i) { return i * 1.0009765625e-4; });
  char text[200];
  std::snprintf(text, sizeof(text), R"({"type":"photos_at","id":4,"point":[%.17g,%.17g,%.17g]})", x, -x, 0.5 * x);
  RC_ASSERT(std::get<PhotosAtRequest>(ParseClientMessage(text)).point_enu == Eigen::Vector3d(x, -x, 0.5 * x));
}

TEST(SimplePolygons, AreTakenInBothDirections) {
  using Polygon = std::vector<Eigen::Vector2d>;
  Polygon house = {{0, 0}, {10, 0}, {10, 6}, {5, 9}, {0, 6}};
  EXPECT_TRUE(IsSimplePolygon(house));
  std::reverse(house.begin(), house.end());
  EXPECT_TRUE(IsSimplePolygon(house));
  EXPECT_TRUE(IsSimplePolygon({{0, 0}, {10, 0}, {5, 1}, {5, 9}}));             // not convex
  EXPECT_TRUE(IsSimplePolygon({{0, 0}, {5, 0}, {10, 0}, {10, 5}}));            // a corner on a straight edge
  EXPECT_TRUE(IsSimplePolygon({{1e7, 1e7}, {1e7 - 1, 1e7}, {1e7, 1e7 - 1}}));  // small and far away
}

TEST(SimplePolygons, AreNothingElse) {
  EXPECT_FALSE(IsSimplePolygon({}));
  EXPECT_FALSE(IsSimplePolygon({{0, 0}, {1, 0}}));
  EXPECT_FALSE(IsSimplePolygon({{0, 0}, {10, 10}, {10, 0}, {0, 10}}));              // bow tie
  EXPECT_FALSE(IsSimplePolygon({{0, 0}, {5, 0}, {10, 0}}));                         // a line
  EXPECT_FALSE(IsSimplePolygon({{0, 0}, {10, 0}, {10, 0}, {0, 10}}));               // a corner twice
  EXPECT_FALSE(IsSimplePolygon({{0, 0}, {10, 0}, {4, 0}, {4, 5}}));                 // goes back over an edge
  EXPECT_FALSE(IsSimplePolygon({{0, 0}, {10, 0}, {10, 10}, {5, 0}, {0, 10}}));      // touches an edge with a corner
  EXPECT_FALSE(IsSimplePolygon({{0, 0}, {4, 4}, {8, 0}, {8, 8}, {4, 4}, {0, 8}}));  // touches itself in a corner
  EXPECT_FALSE(IsSimplePolygon({{0, 0}, {10, 0}, {10, std::nan("")}, {0, 10}}));
}

}  // namespace
}  // namespace skyquilt::viewer
