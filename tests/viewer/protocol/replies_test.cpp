#include "viewer/protocol/replies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/base/json_text.h"

namespace skyquilt::viewer {
namespace {

using nlohmann::json;

const double kNaN = std::nan("");

TEST(Replies, GreetAndTellOfTheEngine) {
  const EngineState state{.ready = false, .reason = "no scene.h5", .revision = 3, .exposure = "normal", .clients = 2, .ranks = 4};
  const json engine = {{"ready", false}, {"reason", "no scene.h5"}, {"revision", 3}, {"exposure", "normal"}, {"clients", 2}, {"ranks", 4}};
  EXPECT_EQ(base::ParseJson(WelcomeText(18446744073709551615U, state)),
            json({{"type", "welcome"}, {"version", 1}, {"client", 18446744073709551615U}, {"engine", engine}}));
  EXPECT_EQ(base::ParseJson(EngineText(state)), json({{"type", "engine"}, {"engine", engine}}));
}

TEST(Replies, ReportErrors) {
  EXPECT_EQ(base::ParseJson(ErrorText("wrong \"x\"")), json({{"type", "error"}, {"message", "wrong \"x\""}}));
  EXPECT_EQ(base::ParseJson(ErrorText("wrong", 0)), json({{"type", "error"}, {"message", "wrong"}, {"id", 0}}));
  // Bytes that are not UTF-8, and texts without end.
  EXPECT_EQ(base::ParseJson(ErrorText("a\xFFz"))["message"], "a\xEF\xBF\xBDz");
  std::string umlauts = "x";
  for (int i = 0; i < 5000; ++i) umlauts += "\xC3\xA4";
  const std::string message = base::ParseJson(ErrorText(umlauts))["message"];
  EXPECT_LT(message.size(), 2100U);
  EXPECT_EQ(message.find("\xEF\xBF\xBD"), std::string::npos) << "cut within a character";
}

TEST(Replies, NumbersThatAreNotFiniteBecomeNull) {
  EXPECT_EQ(base::ParseJson(ProfileText(9, 5.5, {1.25, kNaN}, {kNaN, std::numeric_limits<double>::infinity()})),
            json({{"type", "profile"}, {"id", 9}, {"length_m", 5.5}, {"heights_m", {1.25, nullptr}}, {"spreads_m", {nullptr, nullptr}}}));
  EXPECT_EQ(base::ParseJson(ProgressText(1, kNaN))["fraction"], 0.0);
  EXPECT_EQ(base::ParseJson(ProgressText(1, 7.0))["fraction"], 1.0);
}

TEST(Replies, PickedPointsAreThereOnlyWithASurface) {
  SurfacePoint point{.hit = true, .point_enu = {1, 2, 3.000000001}, .depth_m = 10, .spread_m = kNaN, .opacity = 0.5};
  EXPECT_EQ(base::ParseJson(PickedText(4, point)), json({{"type", "picked"},
                                                         {"id", 4},
                                                         {"hit", true},
                                                         {"point", {1.0, 2.0, 3.000000001}},
                                                         {"depth_m", 10.0},
                                                         {"spread_m", nullptr},
                                                         {"opacity", 0.5}}));
  point.hit = false;
  const json missed = base::ParseJson(PickedText(4, point));
  EXPECT_EQ(missed["hit"], false);
  EXPECT_TRUE(missed["point"].is_null());
  EXPECT_TRUE(missed["depth_m"].is_null());
}

TEST(Replies, AnswerTheOtherQuestions) {
  EXPECT_EQ(base::ParseJson(PhotosText(2, false, {})), json({{"type", "photos"}, {"id", 2}, {"checked", false}, {"photos", json::array()}}));
  const json photos = base::ParseJson(PhotosText(2, true, {{.photo = 5, .pixel = {10.5, 20}, .distance_m = 80, .gsd_m = 0.02, .visible = true}}));
  EXPECT_EQ(photos["photos"], json::array({{{"photo", 5}, {"pixel", {10.5, 20.0}}, {"distance_m", 80.0}, {"gsd_m", 0.02}, {"visible", true}}}));
  const VolumeResult volume{.cell_m = 0.1,
                            .cells = 100,
                            .filled = 0.9,
                            .plan_area_m2 = 1,
                            .surface_area_m2 = 2,
                            .cut_m3 = 5,
                            .fill_m3 = 3,
                            .net_m3 = 2,
                            .sigma_m3 = kNaN,
                            .base_mean_m = -4};
  EXPECT_EQ(base::ParseJson(VolumeText(8, volume)), json({{"type", "volume"},
                                                          {"id", 8},
                                                          {"cell_m", 0.1},
                                                          {"cells", 100},
                                                          {"filled", 0.9},
                                                          {"plan_area_m2", 1.0},
                                                          {"surface_area_m2", 2.0},
                                                          {"cut_m3", 5.0},
                                                          {"fill_m3", 3.0},
                                                          {"net_m3", 2.0},
                                                          {"sigma_m3", nullptr},
                                                          {"base_mean_m", -4.0}}));
  const TrustMapResult trust{.url = "pictures/2.png", .min_enu = {-1, -2}, .max_enu = {3, 4}, .scale = 0.25};
  EXPECT_EQ(base::ParseJson(TrustMapText(9, trust)),
            json({{"type", "trust_map"}, {"id", 9}, {"url", "pictures/2.png"}, {"min", {-1.0, -2.0}}, {"max", {3.0, 4.0}}, {"scale", 0.25}}));
  const ErrorMapResult map{.url = "pictures/1.png", .min_enu = {-1, -2}, .max_enu = {3, 4}, .scale = 0.1, .photos = 6, .of_photos = 7};
  EXPECT_EQ(base::ParseJson(ErrorMapText(8, map)), json({{"type", "error_map"},
                                                         {"id", 8},
                                                         {"url", "pictures/1.png"},
                                                         {"min", {-1.0, -2.0}},
                                                         {"max", {3.0, 4.0}},
                                                         {"scale", 0.1},
                                                         {"photos", 6},
                                                         {"of_photos", 7}}));
}

}  // namespace
}  // namespace skyquilt::viewer
