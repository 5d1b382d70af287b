// What sessions may do, by the link that they came from.
#include "tests/viewer/server/server_fixture.h"

namespace skyquilt::viewer {
namespace {

const std::string kAsset = "tour/assets/" + std::string(64, 'a') + ".glb";

class RightsTest : public ServerTest {
 protected:
  std::string Origin() const { return "Origin: " + origin_ + "\r\n"; }
};

TEST_F(RightsTest, EveryMethodAndPathAgainstEveryRight) {
  Start({.rights = {Right::kPlay, Right::kView, Right::kEdit}});
  struct Case {
    std::string start;
    int play, view, edit;
  };
  const Case cases[] = {
      {"GET /", 200, 200, 200},
      {"GET /app.js", 200, 200, 200},
      {"GET /data/text", 200, 200, 200},
      {"HEAD /data/text", 200, 200, 200},
      {"GET /data/tour.json", 404, 404, 404},
      {"GET /data/" + kAsset, 404, 404, 404},
      {"GET /data/rights.json", 200, 200, 200},
      {"HEAD /data/rights.json", 200, 200, 200},
      {"PUT /data/measurements.geojson", 403, 204, 204},
      {"PUT /data/gcp.json", 403, 204, 204},
      {"PUT /data/camera_path.json", 403, 204, 204},
      {"PUT /data/anything", 403, 204, 204},
      {"PUT /data/rights.json", 403, 204, 204},
      {"PUT /data/tour.json", 403, 403, 204},
      {"PUT /data/t%6fur.json", 403, 403, 204},
      {"PUT /data/" + kAsset, 403, 403, 204},
      {"PUT /data/tour/assets/", 403, 403, 204},
      {"PUT /data/tour/x", 403, 403, 204},
      {"PUT /data/", 404, 404, 404},
      {"PUT /", 405, 405, 405},
      {"POST /data/tour.json", 405, 405, 405},
      {"DELETE /data/" + kAsset, 405, 405, 405},
      {"PATCH /data/tour.json", 405, 405, 405},
      {"OPTIONS /data/tour.json", 405, 405, 405},
  };
  for (const Right right : {Right::kPlay, Right::kView, Right::kEdit}) {
    const std::string cookie = Login(right);
    ASSERT_NE(cookie, "");
    for (const Case& one : cases) {
      const int expected = right == Right::kPlay ? one.play : right == Right::kView ? one.view : one.edit;
      data_.saved.clear();
      const bool put = one.start.starts_with("PUT");
      EXPECT_EQ(Status(Ask(one.start, cookie, Origin(), put ? "{}" : "")), expected) << one.start << " right " << static_cast<int>(right);
      EXPECT_EQ(data_.saved.size(), expected == 204 ? 1U : 0U) << one.start;
      if (put) {
        EXPECT_EQ(Status(Ask(one.start, "", Origin(), "{}")), 403) << "without a cookie";
        EXPECT_GE(Status(Ask(one.start, cookie, "Origin: http://evil.example\r\n", "{}")), 403) << "from another page";
      }
    }
    EXPECT_TRUE(OpenWebsocket(cookie)) << "all may look";
  }
}

TEST_F(RightsTest, ThePageIsToldWhatItMayDo) {
  Start({.rights = {Right::kPlay, Right::kView, Right::kEdit}});
  const auto rights = [&](Right right) {
    const auto reply = Ask("GET /data/rights.json", Login(right));
    EXPECT_EQ(reply->headers.at("content-type"), "application/json");
    EXPECT_EQ(reply->headers.at("cache-control"), "no-store");
    return reply->body;
  };
  EXPECT_EQ(rights(Right::kPlay), "{\"documents\": false, \"tour\": false}\n");
  EXPECT_EQ(rights(Right::kView), "{\"documents\": true, \"tour\": false}\n");
  EXPECT_EQ(rights(Right::kEdit), "{\"documents\": true, \"tour\": true}\n");
}

TEST_F(RightsTest, RefusalsSayWhatHelps) {
  Start({.rights = {Right::kPlay, Right::kView}});
  EXPECT_EQ(Ask("PUT /data/tour.json", Login(Right::kView), Origin(), "{}")->body, "start the viewer with --edit to change the tour\n");
  EXPECT_NE(Ask("PUT /data/tour.json", Login(Right::kPlay), Origin(), "{}")->body.find("playing only"), std::string::npos);
}

TEST_F(RightsTest, EachLinkIsRenewedWithItsRight) {
  Start({.rights = {Right::kEdit, Right::kPlay}});
  std::mutex mutex;
  std::vector<std::pair<Right, std::string>> used;
  server_->OnLinkUsed([&](Right right, const std::string& next) {
    const std::lock_guard lock(mutex);
    used.emplace_back(right, next);
  });
  const std::string edit = LinkTarget(Right::kEdit), play = LinkTarget(Right::kPlay);
  for (int i = 0; i < 2; ++i) {
    ASSERT_NE(Login(Right::kPlay), "");
    const std::lock_guard lock(mutex);
    ASSERT_EQ(used.size(), static_cast<size_t>(i) + 1);
    EXPECT_EQ(used.back(), std::pair(Right::kPlay, server_->LaunchLink(Right::kPlay)));
  }
  EXPECT_EQ(LinkTarget(Right::kEdit), edit) << "the other still works";
  EXPECT_EQ(Status(Ask("GET " + play, "")), 403);
  EXPECT_NE(Login(Right::kEdit), "");
  EXPECT_EQ(Status(Ask("GET " + edit, "")), 403);
}

}  // namespace
}  // namespace skyquilt::viewer
