// Uploads: large bodies, a limited number at a time, and clients that do not finish them.
#include <chrono>
#include <thread>

#include "tests/viewer/server/server_fixture.h"

namespace skyquilt::viewer {
namespace {

using Clock = std::chrono::steady_clock;

class UploadTest : public ServerTest {
 protected:
  void StartEditing(ServerOptions options = {}) {
    options.rights = {Right::kEdit};
    Start(options);
    cookie_ = Login(Right::kEdit);
  }
  std::string Head(const std::string& name, size_t bytes, const std::string& extra = "") const {
    return Request("PUT /data/tour/assets/" + name, cookie_,
                   "Origin: " + origin_ + "\r\n" + extra + "Content-Length: " + std::to_string(bytes) + "\r\n");
  }
};

TEST_F(UploadTest, FiftyMebibytesArriveWholeAndNoByteMore) {
  StartEditing();
  std::string body(kMaxUploadBytes, '\0');
  for (size_t i = 0; i < body.size(); i += 1021) body[i] = static_cast<char>(i * 2654435761U >> 13U);
  RawClient client(server_->port());
  ASSERT_TRUE(client.Send(Head("a", body.size())) && client.Send(body));
  EXPECT_EQ(Status(client.ReadReply()), 204);
  EXPECT_TRUE(data_.saved["tour/assets/a"] == body);
  client.Send(Request("GET /data/text", cookie_));
  EXPECT_EQ(Status(client.ReadReply()), 200) << "the connection goes on";
  const auto reply = AskRaw(Head("b", body.size() + 1));
  ASSERT_EQ(Status(reply), 413) << "refused before it is sent";
  EXPECT_NE(reply->body.find("50 MiB"), std::string::npos);
  EXPECT_EQ(Status(AskRaw(Request("PUT /data/tour.json", cookie_, "Origin: " + origin_ + "\r\nContent-Length: 1048577\r\n"))), 413)
      << "documents stay small";
  EXPECT_EQ(data_.saved.size(), 1U);
}

TEST_F(UploadTest, LengthIsNeeded) {
  StartEditing();
  const std::string chunked = Request("PUT /data/tour/assets/a", cookie_, "Origin: " + origin_ + "\r\nTransfer-Encoding: chunked\r\n");
  EXPECT_EQ(Status(AskRaw(chunked + "5\r\nhello\r\n0\r\n\r\n")), 411);
  EXPECT_TRUE(data_.saved.empty());
}

TEST_F(UploadTest, OnlySoManyAtATime) {
  StartEditing({.max_uploads = 2});
  std::vector<std::unique_ptr<RawClient>> under_way;
  for (int i = 0; i < 2; ++i) {
    under_way.push_back(std::make_unique<RawClient>(server_->port()));
    under_way.back()->Send(Head("a" + std::to_string(i), 1000, "Expect: 100-continue\r\n"));
    ASSERT_EQ(Status(under_way.back()->ReadReply(true)), 100);
  }
  const auto refused = AskRaw(Head("c", 3) + "abc");
  ASSERT_EQ(Status(refused), 503);
  EXPECT_EQ(refused->headers.count("retry-after"), 1U);
  EXPECT_EQ(Status(Ask("PUT /data/gcp.json", cookie_, "Origin: " + origin_ + "\r\n", "{}")), 204) << "documents are saved meanwhile";
  // One ends well, the other's client goes away: both make room.
  under_way[0]->Send(std::string(1000, 'x'));
  EXPECT_EQ(Status(under_way[0]->ReadReply()), 204);
  EXPECT_EQ(Status(AskRaw(Head("c", 3) + "abc")), 204);
  under_way.clear();
  for (int i = 0; i < 4; ++i) {
    const auto deadline = Clock::now() + std::chrono::seconds(5);
    while (Status(AskRaw(Head("d", 3) + "abc")) != 204 && Clock::now() < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_EQ(data_.saved["tour/assets/d"], "abc");
  EXPECT_FALSE(data_.saved.contains("tour/assets/a1")) << "half a file is none";
}

TEST_F(UploadTest, MayTakeLongerThanOtherRequestsAsLongAsItComes) {
  StartEditing({.handshake_s = 0.4});
  RawClient client(server_->port());
  client.Send(Head("a", 30));
  for (int i = 0; i < 30; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    ASSERT_TRUE(client.Send("x"));
  }
  EXPECT_EQ(Status(client.ReadReply()), 204);
  RawClient silent(server_->port());
  silent.Send(Head("b", 30) + "x");
  EXPECT_TRUE(silent.ReadToEnd()) << "one that stops is cut off";
}

TEST_F(UploadTest, ByteByByteIsTooSlow) {
  StartEditing({.slow_answer_s = 0.2, .min_answer_bytes_per_s = 1e9});
  RawClient client(server_->port());
  client.Send(Head("a", 1000));
  const auto deadline = Clock::now() + std::chrono::seconds(5);
  while (client.Send("x") && !client.IsClosed() && Clock::now() < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(client.IsClosed());
  EXPECT_TRUE(data_.saved.empty());
}

TEST_F(UploadTest, ServerEndsAtOnceWhileOneIsUnderWay) {
  StartEditing();
  RawClient client(server_->port());
  client.Send(Head("a", 1000) + "x");
  const auto begin = Clock::now();
  server_.reset();
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(3));
  EXPECT_TRUE(client.ReadToEnd());
}

}  // namespace
}  // namespace skyquilt::viewer
