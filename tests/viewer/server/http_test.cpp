// The server over HTTP: launch link, cookies, hosts, methods, paths, sizes, files.
#include <fstream>

#include "core/base/errors.h"
#include "tests/support/error_of.h"
#include "tests/viewer/server/server_fixture.h"

namespace skyquilt::viewer {
namespace {

using HttpTest = ServerTest;

TEST_F(HttpTest, LinkIsExchangedForACookieOnce) {
  std::mutex mutex;
  std::string next;
  server_->OnLinkUsed([&](Right right, const std::string& link) {
    const std::lock_guard lock(mutex);
    EXPECT_EQ(right, Right::kView);
    next = link;
  });
  const std::string link = server_->LaunchLink(Right::kView), target = LinkTarget();
  EXPECT_TRUE(link.starts_with(origin_ + "/?token="));
  const auto reply = Ask("GET " + target, "");
  ASSERT_EQ(Status(reply), 303);
  EXPECT_EQ(reply->headers.at("location"), "/");
  const std::string set = reply->headers.at("set-cookie");
  EXPECT_TRUE(set.starts_with("skyquilt_" + std::to_string(server_->port()) + "="));
  EXPECT_NE(set.find("HttpOnly"), std::string::npos);
  EXPECT_NE(set.find("SameSite=Strict"), std::string::npos);
  {
    const std::lock_guard lock(mutex);
    EXPECT_EQ(next, server_->LaunchLink(Right::kView));
    EXPECT_NE(next, link);
  }
  const std::string cookie = set.substr(0, set.find(';'));
  EXPECT_EQ(Ask("GET /", cookie)->body, "<p>front end</p>");
  // Again: refused without the cookie, harmless with it.
  const auto used = Ask("GET " + target, "");
  EXPECT_EQ(Status(used), 403);
  EXPECT_NE(used->body.find("newest link"), std::string::npos);
  EXPECT_EQ(used->body.find("<script"), std::string::npos);
  EXPECT_EQ(Status(Ask("GET " + target, cookie)), 303);
}

TEST_F(HttpTest, HeadDoesNotUseUpTheLink) {
  const std::string target = LinkTarget();
  EXPECT_EQ(Status(Ask("HEAD " + target, "")), 403);
  EXPECT_EQ(LinkTarget(), target);
}

TEST_F(HttpTest, NothingWithoutAValidCookie) {
  const std::string good = Login();
  const std::string name = good.substr(0, good.find('='));
  for (const std::string& cookie : {std::string(), name + "=", name + "=" + std::string(64, '0'), good + "0", "x" + good, std::string("garbage")}) {
    for (const std::string start :
         {"GET /", "GET /app.js", "GET /data/text", "GET /ws", "HEAD /data/text", "PUT /data/text", "POST /", "OPTIONS /"}) {
      EXPECT_EQ(Status(Ask(start, cookie, "Origin: " + origin_ + "\r\n")), 403) << start << " " << cookie;
    }
  }
  EXPECT_TRUE(data_.asked.empty());
  EXPECT_TRUE(data_.saved.empty());
}

TEST_F(HttpTest, GuessingTokensIsStopped) {
  for (int i = 0; i < 20; ++i) EXPECT_EQ(Status(Ask("GET /?token=" + std::to_string(i), "")), 403);
  EXPECT_EQ(Status(Ask("GET /?token=1", "")), 429);
  EXPECT_EQ(Status(Ask("GET /?token=x", cookie_)), 303) << "an old link";
  EXPECT_EQ(Status(Ask("GET /", cookie_)), 200);
  EXPECT_EQ(Status(Ask("GET " + LinkTarget(), "")), 303) << "strangers must not lock out whoever has the link";
}

TEST_F(HttpTest, ForeignHostsAreRefusedFirst) {
  Start({.extra_hosts = {"survey-pc"}});
  const std::string port = ":" + std::to_string(server_->port());
  const std::string target = LinkTarget();
  const std::string cookie = Login();
  const auto with_host = [&](const std::string& start, const std::string& lines) {
    return Status(AskRaw(start + " HTTP/1.1\r\n" + lines + "Cookie: " + cookie + "\r\n\r\n"));
  };
  for (const std::string& lines :
       {std::string("Host: evil.example" + port + "\r\n"), std::string("Host: evil.example\r\n"), std::string(), std::string("Host: localhost\r\n"),
        "Host: " + host_ + "\r\nHost: evil.example\r\n", "Host: " + host_ + ".evil.example\r\n", std::string("Host: \r\n")}) {
    EXPECT_EQ(with_host("GET /", lines), 403) << lines;
    EXPECT_EQ(with_host("GET " + LinkTarget(), lines), 403) << lines;
    EXPECT_EQ(with_host("GET /data/text", lines), 403) << lines;
  }
  EXPECT_NE(LinkTarget(), target);
  for (const std::string host : {"localhost", "LocalHost", "127.0.0.1", "survey-pc"}) {
    EXPECT_EQ(with_host("GET /", "Host: " + host + port + "\r\n"), 200) << host;
  }
  EXPECT_EQ(with_host("GET http://" + host_ + "/", "Host: " + host_ + "\r\n"), 400);
  EXPECT_TRUE(data_.asked.empty());
}

TEST_F(HttpTest, EveryAnswerHasTheSecurityHeaders) {
  for (const auto& reply : {Ask("GET /", cookie_), Ask("GET /", ""), Ask("GET /data/text", cookie_), Ask("GET /data/nothing", cookie_),
                            Ask("DELETE /", cookie_), AskRaw("nonsense\r\n\r\n"), AskRaw("GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n"),
                            AskRaw(UpgradeRequest(cookie_, origin_), true), Ask("GET /?token=x", "")}) {
    ASSERT_TRUE(reply);
    const std::string policy = reply->headers.count("content-security-policy") != 0 ? reply->headers.at("content-security-policy") : "";
    EXPECT_TRUE(policy.starts_with("default-src 'self'; ")) << reply->status;
    EXPECT_NE(policy.find("script-src 'self';"), std::string::npos);
    EXPECT_NE(policy.find("frame-ancestors 'none'"), std::string::npos);
    EXPECT_EQ(policy.find("unsafe"), std::string::npos);
    EXPECT_EQ(policy.find("evil"), std::string::npos);
    EXPECT_EQ(reply->headers.at("x-content-type-options"), "nosniff");
    EXPECT_EQ(reply->headers.at("referrer-policy"), "no-referrer");
    EXPECT_EQ(reply->headers.at("cross-origin-resource-policy"), "same-origin");
    EXPECT_EQ(reply->headers.count("access-control-allow-origin"), 0U);
  }
  EXPECT_NE(Ask("GET /", cookie_)->headers.at("content-security-policy").find("connect-src 'self' blob: ws://" + host_ + ";"), std::string::npos);
  EXPECT_EQ(Ask("GET /data/text", cookie_)->headers.at("cache-control"), "no-store");
  EXPECT_EQ(Ask("GET /data/cached", cookie_)->headers.at("cache-control"), "private, max-age=3600");
}

TEST_F(HttpTest, PathsThatLeaveTheFixedNamesReachNothing) {
  for (const std::string path : {"/data/../text",
                                 "/data/%2e%2e/text",
                                 "/data/..%2ftext",
                                 "/data/.%2e/text",
                                 "/data/%2E%2E%2Ftext",
                                 "/data/%252e%252e/text",
                                 "/data/..\\text",
                                 "/data/..%5ctext",
                                 "/data/%5c..%5ctext",
                                 "/data//etc/passwd",
                                 "/data/%2fetc%2fpasswd",
                                 "/data/text%00.png",
                                 "/data/%c0%ae%c0%ae/text",
                                 "/data/a%",
                                 "/data/%zz",
                                 "/data/te~xt",
                                 "/..",
                                 "/%2e%2e/%2e%2e/etc/passwd",
                                 "//etc/passwd",
                                 "/data/....//text",
                                 "/data/file:///etc/passwd"}) {
    EXPECT_EQ(Status(Ask("GET " + path, cookie_)), 400) << path;
    EXPECT_EQ(Status(Ask("PUT " + path, cookie_, "Origin: " + origin_ + "\r\n", "x")), 400) << path;
  }
  for (const std::string path : {"/etc/passwd", "/data", "/data/", "/index.html", "/app.js/", "/Data/text"}) {
    EXPECT_EQ(Status(Ask("GET " + path, cookie_)), 404) << path;
  }
  EXPECT_TRUE(data_.asked.empty());
  EXPECT_TRUE(data_.saved.empty());
}

TEST_F(HttpTest, DataIsAskedWithPathAndQuery) {
  const auto reply = Ask("GET /data/text?a=%20", cookie_);
  EXPECT_EQ(Status(reply), 200);
  EXPECT_EQ(reply->body, "hello");
  EXPECT_EQ(reply->headers.at("content-type"), "text/plain");
  EXPECT_EQ(data_.asked, std::vector<std::string>({"text?a=%20"}));
  EXPECT_EQ(Status(Ask("GET /data/" + std::string(201, 'a'), cookie_)), 404);
  EXPECT_EQ(Status(Ask("GET /data/text?" + std::string(101, 'a'), cookie_)), 414);
  EXPECT_EQ(data_.asked.size(), 1U);
}

TEST_F(HttpTest, SourceThatThrowsIsAnErrorWithoutItsReason) {
  const auto reply = Ask("GET /data/throws", cookie_);
  EXPECT_EQ(Status(reply), 500);
  EXPECT_EQ(reply->body.find("secret"), std::string::npos);
  EXPECT_EQ(Status(Ask("GET /data/text", cookie_)), 200);
  const auto split = Ask("GET /data/split", cookie_);
  EXPECT_EQ(Status(split), 200);
  EXPECT_EQ(split->headers.count("set-cookie"), 0U);
}

TEST_F(HttpTest, MethodsThatAreNotAllowed) {
  const std::string cookie = Login(), origin = "Origin: " + origin_ + "\r\n";
  for (const std::string start :
       {"POST /data/text", "DELETE /data/text", "PUT /", "PUT /app.js", "OPTIONS /data/text", "PATCH /", "BREW /", "TRACE /"}) {
    const auto reply = Ask(start, cookie, origin);
    EXPECT_EQ(Status(reply), 405) << start;
    EXPECT_NE(reply->headers.at("allow").find("GET"), std::string::npos);
  }
  EXPECT_EQ(Status(Ask("GET /data/text", cookie, "", "a body")), 400);
  EXPECT_EQ(Status(Ask("GET /ws", cookie, origin)), 426);
  EXPECT_EQ(Status(Ask("GET /favicon.ico", cookie)), 204);
}

TEST_F(HttpTest, PutOnlyFromTheOwnPage) {
  for (const std::string& origin : {std::string(), std::string("Origin: null\r\n"), std::string("Origin: http://evil.example\r\n"),
                                    "Origin: https://" + host_ + "\r\n", "Origin: http://localhost:" + std::to_string(server_->port()) + "\r\n",
                                    "Origin: " + origin_ + ".evil.example\r\n", "Origin: " + origin_ + "\r\nOrigin: http://evil.example\r\n"}) {
    EXPECT_EQ(Status(Ask("PUT /data/gcp.json", cookie_, origin, "{}")), 403) << origin;
  }
  EXPECT_TRUE(data_.saved.empty());
  EXPECT_EQ(Status(Ask("PUT /data/gcp.json", cookie_, "Origin: " + origin_ + "\r\n", "{}")), 204);
  EXPECT_EQ(data_.saved["gcp.json"], "{}");
}

TEST_F(HttpTest, TagsOfDocumentsPass) {
  const std::string cookie = Login(), origin = "Origin: " + origin_ + "\r\n";
  const auto kept = Ask("GET /data/kept", cookie);
  ASSERT_EQ(Status(kept), 200);
  EXPECT_EQ(kept->body, "shared");
  EXPECT_EQ(kept->headers.at("etag"), "\"a1\"");
  EXPECT_EQ(Ask("GET /data/text", cookie)->headers.count("etag"), 0U);
  for (const std::string line :
       {"", "If-Match: \"a1\"\r\n", "If-Match: W/\"a2\"\r\n", "If-Match: *\r\n", "if-match: a3\r\n", "If-Match: \"a4\", W/\"a5\" ,a6\r\n"}) {
    const auto put = Ask("PUT /data/gcp.json", cookie, origin + line, "{}");
    ASSERT_EQ(Status(put), 204);
    EXPECT_EQ(put->headers.at("etag"), "\"new\"");
  }
  EXPECT_EQ(data_.matched, std::vector<std::string>({"", "a1", "a2", "", "a3", "a4 a5 a6"}));
}

TEST_F(HttpTest, TagOfOneRequestIsNotThatOfTheNext) {
  const std::string cookie = Login(), origin = "Origin: " + origin_ + "\r\n";
  RawClient client(server_->port());
  for (const std::string line : {"If-Match: \"a1\"\r\n", ""}) {
    client.Send(Request("PUT /data/gcp.json", cookie, origin + line, "{}"));
    EXPECT_EQ(Status(client.ReadReply()), 204);
  }
  EXPECT_EQ(data_.matched, std::vector<std::string>({"a1", ""}));
}

TEST_F(HttpTest, PutOfAMegabyteAndMore) {
  const std::string cookie = Login(), origin = "Origin: " + origin_ + "\r\n";
  const std::string body(1U << 20U, 'm');
  EXPECT_EQ(Status(Ask("PUT /data/big", cookie, origin, body)), 204);
  EXPECT_EQ(data_.saved["big"], body);
  EXPECT_EQ(Status(Ask("PUT /data/bigger", cookie, origin, body + "m")), 413);
  const auto chunked = Ask("PUT /data/chunked", cookie, origin + "Transfer-Encoding: chunked\r\n\r\n5\r\nhello\r\n0\r\n");
  EXPECT_EQ(Status(chunked), 204);
  EXPECT_EQ(data_.saved["chunked"], "hello");
  std::string chunks;
  for (int i = 0; i < 17; ++i) chunks += "10000\r\n" + std::string(65536, 'c') + "\r\n";
  EXPECT_EQ(Status(AskRaw(Request("PUT /data/chunks", cookie, origin + "Transfer-Encoding: chunked\r\n") + chunks + "0\r\n\r\n")), 413);
  EXPECT_EQ(data_.saved.count("chunks") + data_.saved.count("bigger"), 0U);
}

TEST_F(HttpTest, ExpectContinueIsAnswered) {
  RawClient client(server_->port());
  client.Send(Request("PUT /data/x", cookie_, "Origin: " + origin_ + "\r\nExpect: 100-continue\r\nContent-Length: 3\r\n"));
  EXPECT_EQ(Status(client.ReadReply()), 100);
  client.Send("abc");
  EXPECT_EQ(Status(client.ReadReply()), 204);
  EXPECT_EQ(data_.saved["x"], "abc");
}

TEST_F(HttpTest, KeepAliveHeadAndPipelinedRequests) {
  RawClient client(server_->port());
  client.Send(Request("HEAD /data/text", cookie_));
  const auto head = client.ReadReply(true);
  ASSERT_EQ(Status(head), 200);
  EXPECT_EQ(head->headers.at("content-length"), "5");
  EXPECT_EQ(head->headers.at("connection"), "keep-alive");
  client.Send(Request("GET /data/text", cookie_) + Request("GET /app.js", cookie_) + Request("GET /", cookie_, "Connection: close\r\n"));
  EXPECT_EQ(client.ReadReply()->body, "hello");
  EXPECT_EQ(client.ReadReply()->body, "let a = 1;");
  EXPECT_EQ(client.ReadReply()->headers.at("connection"), "close");
  EXPECT_TRUE(client.ReadToEnd());
}

TEST_F(HttpTest, FilesAreSentWholeAndMissingOnesAreNotFound) {
  data_.file = std::filesystem::path(::testing::TempDir()) / "skyquilt_server_test.glb";
  std::string content(3U << 20U, '\0');
  for (size_t i = 0; i < content.size(); ++i) content[i] = static_cast<char>(i * 2654435761U >> 13U);
  std::ofstream(data_.file, std::ios::binary) << content;
  RawClient client(server_->port());
  client.Send(Request("GET /data/file", cookie_));
  const auto reply = client.ReadReply();
  ASSERT_EQ(Status(reply), 200);
  EXPECT_TRUE(reply->body == content);
  client.Send(Request("HEAD /data/file", cookie_));
  EXPECT_EQ(client.ReadReply(true)->headers.at("content-length"), std::to_string(content.size()));
  std::ofstream(data_.file, std::ios::binary | std::ios::trunc).close();
  client.Send(Request("GET /data/file", cookie_));
  EXPECT_EQ(client.ReadReply()->headers.at("content-length"), "0");
  std::filesystem::remove(data_.file);
  client.Send(Request("GET /data/file", cookie_));
  EXPECT_EQ(Status(client.ReadReply()), 404);
  client.Send(Request("GET /data/folder", cookie_));
  EXPECT_EQ(Status(client.ReadReply()), 404);
}

TEST_F(HttpTest, PortInUseAndForeignAddressesAreUsageErrors) {
  RecordingHandler handler;
  RecordingData data;
  const auto message = [&](const ServerOptions& options) -> std::string {
    return UsageErrorOf([&] { const Server second(options, handler, data); });
  };
  const std::string in_use = message({.port = server_->port()});
  EXPECT_NE(in_use.find(std::to_string(server_->port())), std::string::npos);
  EXPECT_NE(in_use.find("--port"), std::string::npos);
  EXPECT_NE(message({.address = "192.0.2.1"}).find("192.0.2.1"), std::string::npos);
  EXPECT_NE(message({.address = "no address"}), "");
  EXPECT_NE(message({.port = 65536}), "");
  EXPECT_NE(message({.port = -1}), "");
}

TEST_F(HttpTest, PortCanBeUsedAgainAtOnce) {
  const int port = server_->port();
  RawClient client(port);
  client.Send(Request("GET /", Login()));
  EXPECT_EQ(Status(client.ReadReply()), 200);
  server_.reset();
  Start({.port = port});
  EXPECT_EQ(server_->port(), port);
}

}  // namespace
}  // namespace skyquilt::viewer
