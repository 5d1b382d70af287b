// The WebSocket: upgrade, hello, messages in both directions, limits.
#include <thread>

#include "tests/viewer/server/server_fixture.h"

namespace skyquilt::viewer {
namespace {

using WebsocketTest = ServerTest;
constexpr const char* kStop = R"({"type":"stop","seq":7})";
constexpr const char* kBad = R"({"type":"nonsense"})";

TEST_F(WebsocketTest, UpgradeNeedsCookieOriginAndPath) {
  EXPECT_EQ(Status(AskRaw(UpgradeRequest("", origin_))), 403);
  EXPECT_EQ(Status(AskRaw(UpgradeRequest(cookie_ + "x", origin_))), 403);
  for (const std::string& origin : {std::string(), std::string("null"), std::string("http://evil.example"), "https://" + host_,
                                    "http://localhost:" + std::to_string(server_->port()), origin_ + "0"}) {
    EXPECT_EQ(Status(AskRaw(UpgradeRequest(cookie_, origin))), 403) << origin;
  }
  EXPECT_EQ(Status(AskRaw(UpgradeRequest(cookie_, origin_, "/"))), 200);
  EXPECT_EQ(Status(AskRaw(UpgradeRequest(cookie_, origin_, "/data/text"))), 200);
  EXPECT_EQ(Status(AskRaw(UpgradeRequest(cookie_, origin_, "/ws/x"))), 404);
  EXPECT_EQ(Status(AskRaw(UpgradeRequest(cookie_, origin_) + MakeFrame(1, kHello))), 400);
  const auto reply = AskRaw(UpgradeRequest(cookie_, origin_), true);
  ASSERT_EQ(Status(reply), 101);
  EXPECT_EQ(reply->headers.at("sec-websocket-accept"), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
  EXPECT_EQ(reply->headers.count("sec-websocket-extensions"), 0U);
  EXPECT_EQ(server_->clients(), 0);
}

TEST_F(WebsocketTest, MessagesReachTheHandlerAndTextsComeBack) {
  auto client = OpenWebsocket(Login());
  ASSERT_TRUE(client);
  EXPECT_EQ(server_->clients(), 1);
  EXPECT_TRUE(IsServed(*client));
  // In pieces, with a ping between them.
  const std::string text = kStop;
  client->Send(MakeFrame(1, text.substr(0, 5), {.fin = false}) + MakeFrame(9, "ping") + MakeFrame(0, text.substr(5)));
  EXPECT_EQ(client->ReadFrame()->opcode, 10);
  EXPECT_EQ(client->ReadFrame()->payload, "stop 7");
  client->Send(MakeFrame(8, "\x03\xe8"));
  EXPECT_EQ(CloseCode(*client), 1000);
  client.reset();
  EXPECT_TRUE(handler_.WaitFor([&] { return handler_.closed.size() == 1; }));
  EXPECT_EQ(server_->clients(), 0);
}

TEST_F(WebsocketTest, FirstMessageMustBeHelloInThisVersion) {
  for (const std::string text :
       {R"({"type":"hello","version":2})", R"({"type":"hello"})", kStop, kBad, "", "not json", R"({"type":"hello","version":1)"}) {
    const auto client = OpenWebsocket(cookie_, false);
    ASSERT_TRUE(client);
    client->Send(MakeFrame(1, text));
    EXPECT_EQ(CloseCode(*client), 1002) << text;
  }
  EXPECT_EQ(Opened(), 0U);
}

TEST_F(WebsocketTest, HelloMustComeInTime) {
  Start({.handshake_s = 0.3});
  const auto client = OpenWebsocket(Login(), false);
  ASSERT_TRUE(client);
  EXPECT_EQ(CloseCode(*client), 1002);
  // Without an answer to the close, too.
  EXPECT_TRUE(client->ReadToEnd());
}

TEST_F(WebsocketTest, SilentClientIsPingedThenClosed) {
  Start({.idle_s = 0.6});
  const auto client = OpenWebsocket(Login());
  ASSERT_TRUE(client);
  EXPECT_EQ(client->ReadFrame()->opcode, 9);
  EXPECT_TRUE(client->ReadToEnd());
  EXPECT_TRUE(handler_.WaitFor([&] { return handler_.closed.size() == 1; }));
}

TEST_F(WebsocketTest, BadMessagesAreAnsweredAndTenInARowClose) {
  const auto client = OpenWebsocket(Login());
  ASSERT_TRUE(client);
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 9; ++i) client->Send(MakeFrame(1, i == 4 ? kHello : kBad));
    for (int i = 0; i < 9; ++i) EXPECT_NE(client->ReadFrame()->payload.find(R"("error")"), std::string::npos);
    EXPECT_TRUE(IsServed(*client));
  }
  for (int i = 0; i < 10; ++i) client->Send(MakeFrame(1, kBad));
  EXPECT_EQ(CloseCode(*client), 1008);
  EXPECT_TRUE(handler_.WaitFor([&] { return handler_.closed.size() == 1 && handler_.messages[handler_.newest] == 3; }));
}

TEST_F(WebsocketTest, BinaryMessagesClose) {
  const auto client = OpenWebsocket(Login());
  ASSERT_TRUE(client);
  client->Send(MakeFrame(2, kStop));
  EXPECT_EQ(CloseCode(*client), 1003);
}

TEST_F(WebsocketTest, TooManyMessagesOrPingsClose) {
  Start({.max_messages_per_s = 5});
  const auto talker = OpenWebsocket(cookie_), pinger = OpenWebsocket(cookie_), calm = OpenWebsocket(cookie_);
  ASSERT_TRUE(talker && pinger && calm);
  for (int i = 0; i < 40; ++i) talker->Send(MakeFrame(1, kStop));
  EXPECT_EQ(CloseCode(*talker), 1008);
  for (int i = 0; i < 40; ++i) pinger->Send(MakeFrame(9, "x"));
  EXPECT_EQ(CloseCode(*pinger), 1008);
  EXPECT_TRUE(IsServed(*calm));
}

TEST_F(WebsocketTest, HandlerThatThrowsClosesItsClientOnly) {
  const auto first = OpenWebsocket(cookie_), second = OpenWebsocket(cookie_);
  ASSERT_TRUE(first && second);
  handler_.throws = true;
  first->Send(MakeFrame(1, kStop));
  EXPECT_EQ(CloseCode(*first), 1011);
  handler_.throws = false;
  EXPECT_TRUE(IsServed(*second));
}

TEST_F(WebsocketTest, NumberOfClientsIsLimited) {
  Start({.max_clients = 2});
  auto first = OpenWebsocket(cookie_);
  const auto second = OpenWebsocket(cookie_);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(Status(AskRaw(UpgradeRequest(cookie_, origin_))), 503);
  EXPECT_TRUE(IsServed(*second));
  first.reset();
  ASSERT_TRUE(handler_.WaitFor([&] { return handler_.closed.size() == 1; }));
  EXPECT_TRUE(OpenWebsocket(cookie_));
}

TEST_F(WebsocketTest, ManyThreadsSendToSeveralClientsInOrder) {
  std::vector<std::unique_ptr<RawClient>> clients;
  std::vector<ClientId> ids;
  for (int i = 0; i < 3; ++i) {
    clients.push_back(OpenWebsocket(cookie_));
    ASSERT_TRUE(clients.back());
    ids.push_back(handler_.newest);
  }
  constexpr int kMessages = 200;
  std::vector<std::thread> threads;
  for (const ClientId id : ids) {
    threads.emplace_back([&, id] {
      for (int i = 0; i < kMessages; ++i) {
        const std::string text = std::to_string(id) + " " + std::to_string(i) + std::string(static_cast<size_t>(i) * 50, ' ');
        server_->Send(id, {.binary = i % 2 == 1, .bytes = std::make_shared<const std::string>(text)});
        server_->Send(987654321, {.binary = true, .bytes = std::make_shared<const std::string>("nobody")});
        server_->Send(id, {.binary = true, .bytes = nullptr});
      }
    });
  }
  for (size_t c = 0; c < clients.size(); ++c) {
    for (int i = 0; i < kMessages; ++i) {
      const auto frame = clients[c]->ReadFrame();
      ASSERT_TRUE(frame);
      EXPECT_TRUE(frame->payload.starts_with(std::to_string(ids[c]) + " " + std::to_string(i)));
      EXPECT_EQ(frame->opcode, i % 2 == 1 ? 2 : 1);
      EXPECT_TRUE(frame->fin);
    }
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(server_->QueuedBytes(987654321), 0U);
}

TEST_F(WebsocketTest, LargeMessageArrivesInOneFrame) {
  const auto client = OpenWebsocket(Login());
  ASSERT_TRUE(client);
  const std::string bytes(9U << 20U, 'f');
  server_->Send(handler_.newest, {.binary = true, .bytes = std::make_shared<const std::string>(bytes)});
  const auto frame = client->ReadFrame();
  ASSERT_TRUE(frame);
  EXPECT_TRUE(frame->fin && frame->payload == bytes);
}

}  // namespace
}  // namespace skyquilt::viewer
