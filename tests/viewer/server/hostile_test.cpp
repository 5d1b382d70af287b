// Attacks on the server: each is refused or bounded, and the others are served on.
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "tests/viewer/server/server_fixture.h"

namespace skyquilt::viewer {
namespace {

using HostileTest = ServerTest;
using Clock = std::chrono::steady_clock;

constexpr const char* kStopView = R"({"type":"stop","seq":7})";

TEST_F(HostileTest, RequestsThatAreNotHttp) {
  const std::string host = "Host: " + host_ + "\r\n";
  const std::string attacks[] = {
      std::string("\r\n\r\n\r\n\r\n"),
      std::string("GET\r\n\r\n"),
      std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11),
      "GET / HTTP/9.9\r\n" + host + "\r\n",
      "GET / HTTP/1.1\r\n" + host + "a b: c\r\n\r\n",
      "GET / HTTP/1.1\r\n" + host + "Content-Length: -1\r\n\r\n",
      "GET / HTTP/1.1\r\n" + host + "Content-Length: 1\r\nContent-Length: 2\r\n\r\n",
      "GET / HTTP/1.1\r\nHost : x\r\n\r\n",
      "GET /\x01 HTTP/1.1\r\n" + host + "\r\n",
      std::string("GET / HTTP/1.1\r\nHost: a\0b\r\n\r\n", 28),
      "PUT /data/x HTTP/1.1\r\n" + host + "Origin: " + origin_ + "\r\nCookie: " + cookie_ + "\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n"};
  for (const std::string& bytes : attacks) {
    EXPECT_EQ(Status(AskRaw(bytes)), 400) << bytes;
  }
  for (const std::string& bytes : {std::string(), std::string("GET / HT"), "PUT /data/x HTTP/1.1\r\n" + host + "Content-Length: 9\r\n\r\nabc"}) {
    RawClient(server_->port()).Send(bytes);
  }
  EXPECT_EQ(Status(Ask("GET /", cookie_)), 200);
}

TEST_F(HostileTest, BodyOfARefusedRequestIsNotTheNextRequest) {
  const std::string hidden = Request("GET /data/text", cookie_);
  for (const std::string start : {"POST /", "PUT /data/x", "GET /data/text"}) {
    RawClient client(server_->port());
    client.Send(Request(start, cookie_, "", hidden));
    const auto reply = client.ReadReply();
    ASSERT_TRUE(reply);
    EXPECT_GE(reply->status, 400);
    EXPECT_FALSE(client.ReadReply());
  }
  EXPECT_TRUE(data_.asked.empty());
}

TEST_F(HostileTest, SizesAreLimited) {
  EXPECT_EQ(Status(Ask("GET /", cookie_, "X: " + std::string(9000, 'x') + "\r\n")), 431);
  std::string many;
  for (int i = 0; i < 2000; ++i) many += "A" + std::to_string(i) + ": b\r\n";
  EXPECT_EQ(Status(Ask("GET /", cookie_, many)), 431);
  EXPECT_EQ(Status(Ask("GET /" + std::string(3000, 'a'), cookie_)), 414);
  EXPECT_EQ(Status(Ask("GET /" + std::string(100000, 'a'), cookie_)), 431);
  EXPECT_EQ(Status(Ask("PUT /data/x", cookie_, "Origin: " + origin_ + "\r\nContent-Length: 99999999999\r\n")), 413);
  EXPECT_EQ(Status(Ask("GET /", cookie_)), 200);
}

TEST_F(HostileTest, ClientsThatDripBytesAreCutOff) {
  Start({.handshake_s = 0.4, .keep_alive_s = 0.4});
  const std::string starts[] = {"GET / HTTP/1.1\r\nX: ", Request("PUT /data/x", cookie_, "Origin: " + origin_ + "\r\nContent-Length: 100000\r\n"),
                                ""};
  for (const std::string& start : starts) {
    RawClient client(server_->port());
    client.Send(start);
    const auto begin = Clock::now();
    while (!client.IsClosed() && Clock::now() - begin < std::chrono::seconds(5)) {
      if (!start.empty()) client.Send("a");
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    EXPECT_TRUE(client.IsClosed()) << start;
  }
  // Between two requests, too.
  RawClient waiting(server_->port());
  waiting.Send(Request("GET /", cookie_));
  EXPECT_EQ(Status(waiting.ReadReply()), 200);
  EXPECT_TRUE(waiting.ReadToEnd());
  EXPECT_TRUE(data_.saved.empty());
}

TEST_F(HostileTest, ClientThatDoesNotReadItsAnswerIsCutOff) {
  Start({.handshake_s = 0.4});
  data_.file = std::filesystem::path(::testing::TempDir()) / "skyquilt_server_large.bin";
  std::ofstream(data_.file, std::ios::binary) << "";
  std::filesystem::resize_file(data_.file, 64U << 20U);
  RawClient client(server_->port(), 4096);
  client.Send(Request("GET /data/file", cookie_));
  std::this_thread::sleep_for(std::chrono::milliseconds(1200));
  EXPECT_FALSE(client.ReadReply());
  EXPECT_EQ(Status(Ask("GET /", cookie_)), 200);
  std::filesystem::remove(data_.file);
}

TEST_F(HostileTest, ClientThatReadsItsAnswerTooSlowlyIsCutOff) {
  // A rate that no client reaches after it has waited.
  Start({.slow_answer_s = 0.2, .min_answer_bytes_per_s = 1e9});
  data_.file = std::filesystem::path(::testing::TempDir()) / "skyquilt_server_slow.bin";
  std::ofstream(data_.file, std::ios::binary) << "";
  std::filesystem::resize_file(data_.file, 64U << 20U);
  RawClient client(server_->port(), 4096);
  client.Send(Request("GET /data/file", cookie_));
  std::this_thread::sleep_for(std::chrono::milliseconds(400));
  EXPECT_FALSE(client.ReadReply()) << "reading goes on, but below the rate";
  EXPECT_TRUE(client.IsClosed());
  EXPECT_EQ(Status(Ask("GET /data/text", cookie_)), 200);
  std::filesystem::remove(data_.file);
}

TEST_F(HostileTest, TwoHundredConnectionsDoNotLockOthersOut) {
  Start({.max_connections = 32});
  const auto client = OpenWebsocket(cookie_);
  ASSERT_TRUE(client);
  std::vector<std::unique_ptr<RawClient>> strangers;
  for (int i = 0; i < 200; ++i) {
    strangers.push_back(std::make_unique<RawClient>(server_->port()));
    if (i % 2 == 0) strangers.back()->Send("GET / HTTP/1.1\r\n");
  }
  EXPECT_TRUE(IsServed(*client));
  EXPECT_EQ(Status(Ask("GET /data/text", cookie_)), 200);
  EXPECT_NE(Login(), "");
  int closed = 0;
  for (const auto& stranger : strangers) closed += stranger->IsClosed() ? 1 : 0;
  EXPECT_GE(closed, 200 - 32);
}

TEST_F(HostileTest, ConnectionsWithACookieDoNotFillTheServerEither) {
  Start({.max_connections = 8});
  std::vector<std::unique_ptr<RawClient>> idle;
  for (int i = 0; i < 20; ++i) {
    idle.push_back(std::make_unique<RawClient>(server_->port()));
    idle.back()->Send(Request("GET /", cookie_));
    EXPECT_EQ(Status(idle.back()->ReadReply()), 200) << i;
  }
}

TEST_F(HostileTest, ClientThatNeverReadsIsBoundedAndDropped) {
  constexpr size_t kLimit = 1U << 20U;
  Start({.max_queued_bytes = kLimit});
  const auto deaf = OpenWebsocket(cookie_, true, 4096);
  ASSERT_TRUE(deaf);
  const ClientId deaf_id = handler_.newest;
  const auto other = OpenWebsocket(cookie_);
  ASSERT_TRUE(other);
  const auto frame = std::make_shared<const std::string>(100000, 'f');
  const auto deadline = Clock::now() + std::chrono::seconds(8);
  while (server_->clients() == 2 && Clock::now() < deadline) {
    server_->Send(deaf_id, {.binary = true, .bytes = frame});
    ASSERT_LE(server_->QueuedBytes(deaf_id), kLimit);
  }
  EXPECT_TRUE(handler_.WaitFor([&] { return handler_.closed == std::vector<ClientId>({deaf_id}); }));
  EXPECT_EQ(server_->QueuedBytes(deaf_id), 0U);
  EXPECT_TRUE(IsServed(*other));
}

TEST_F(HostileTest, WriteWithoutProgressEndsTheClient) {
  Start({.write_stall_s = 0.3});
  const auto deaf = OpenWebsocket(Login(), true, 4096);
  ASSERT_TRUE(deaf);
  server_->Send(handler_.newest, {.binary = true, .bytes = std::make_shared<const std::string>(30U << 20U, 'f')});
  EXPECT_TRUE(handler_.WaitFor([&] { return handler_.closed.size() == 1; }));
}

TEST_F(HostileTest, MalformedFramesCloseTheirConnectionOnly) {
  const auto other = OpenWebsocket(cookie_);
  ASSERT_TRUE(other);
  const std::string text = kStopView;
  const std::pair<std::string, int> attacks[] = {
      {MakeFrame(1, text, {.masked = false}), 1002},
      {MakeFrame(1, text, {.reserved = 4}), 1002},
      {MakeFrame(1, text, {.reserved = 1}), 1002},
      {MakeFrame(3, text), 1002},
      {MakeFrame(11, text), 1002},
      {MakeFrame(0, text), 1002},
      {MakeFrame(1, text, {.fin = false}) + MakeFrame(1, text), 1002},
      {MakeFrame(9, std::string(126, 'p')), 1002},
      {MakeFrame(9, "p", {.fin = false}), 1002},
      {MakeFrame(8, "\x03"), 1002},
      {MakeFrame(8, std::string("\x03\xed", 2)), 1002},
      {MakeFrame(1, "\xff\xfe"), 1007},
      {MakeFrame(1, std::string(5000, ' ')), 1009},
      {MakeFrame(1, std::string(3000, ' '), {.fin = false}) + MakeFrame(0, std::string(3000, ' ')), 1009},
      {std::string("\x81\xff\xff\xff\xff\xff\xff\xff\xff\xff", 10) + "abcd", 0},
      {std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff", 10) + "abcd", 1009},
  };
  for (const auto& [bytes, code] : attacks) {
    const auto client = OpenWebsocket(cookie_);
    ASSERT_TRUE(client);
    client->Send(bytes);
    const int found = CloseCode(*client);
    if (code != 0) {
      EXPECT_EQ(found, code) << ::testing::PrintToString(bytes.substr(0, 20));
    }
    EXPECT_TRUE(IsServed(*other));
  }
  EXPECT_TRUE(handler_.WaitFor([&] { return handler_.closed.size() == std::size(attacks); }));
}

TEST_F(HostileTest, FloodOfEmptyFragmentsIsEnded) {
  Start({.handshake_s = 1.0});
  const auto client = OpenWebsocket(cookie_), other = OpenWebsocket(cookie_);
  ASSERT_TRUE(client && other);
  client->Send(MakeFrame(1, "", {.fin = false}));
  std::string flood;
  for (int i = 0; i < 1000; ++i) flood += MakeFrame(0, "", {.fin = false});
  const auto deadline = Clock::now() + std::chrono::seconds(8);
  while (client->Send(flood) && !client->IsClosed() && Clock::now() < deadline) {
    EXPECT_TRUE(IsServed(*other));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_TRUE(handler_.WaitFor([&] { return handler_.closed.size() == 1; }));
  EXPECT_TRUE(IsServed(*other));
}

TEST_F(HostileTest, ServiceGoesOnAfterFileDescriptorsRanOut) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  // A listening queue takes the connection although the server cannot accept it yet.
  std::unique_ptr<RawClient> client;
  {
    const int used_by_client = dup(0), next = dup(0);
    ASSERT_GE(next, 0);
    close(used_by_client);
    close(next);
    rlimit low = before;
    low.rlim_cur = static_cast<rlim_t>(next);
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &low), 0);
    client = std::make_unique<RawClient>(server_->port());
    client->Send(Request("GET /", cookie_));
    std::this_thread::sleep_for(std::chrono::milliseconds(150));
    EXPECT_FALSE(client->IsClosed());
    ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
  }
  EXPECT_EQ(Status(client->ReadReply()), 200);
}

TEST_F(HostileTest, ServerEndsAtOnceWithOpenConnections) {
  RawClient silent(server_->port()), half(server_->port()), waiting(server_->port());
  half.Send("GET / HTTP/1.1\r\n");
  waiting.Send(Request("GET /", cookie_));
  EXPECT_EQ(Status(waiting.ReadReply()), 200);
  const auto client = OpenWebsocket(cookie_), deaf = OpenWebsocket(cookie_, true, 4096);
  ASSERT_TRUE(client && deaf);
  server_->Send(handler_.newest, {.binary = true, .bytes = std::make_shared<const std::string>(30U << 20U, 'f')});
  const auto begin = Clock::now();
  server_.reset();
  EXPECT_LT(Clock::now() - begin, std::chrono::seconds(3));
  EXPECT_EQ(handler_.closed.size(), 2U);
  EXPECT_TRUE(silent.ReadToEnd() && half.ReadToEnd() && waiting.ReadToEnd() && client->ReadToEnd());
}

}  // namespace
}  // namespace skyquilt::viewer
