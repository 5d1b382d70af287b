// A running server with a handler and a data source that record what reaches them.
#pragma once

#include <gtest/gtest.h>

#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "tests/viewer/server/raw_client.h"
#include "viewer/server/server.h"

namespace skyquilt::viewer {

class RecordingHandler : public ClientHandler {
 public:
  void OnOpen(ClientId client) override {
    Record([&] { open.insert(client), newest = client; });
  }
  void OnMessage(ClientId client, ClientMessage message) override {
    Record([&] { ++messages[client]; });
    if (throws) throw std::runtime_error("handler fails");
    if (echo && server != nullptr && std::holds_alternative<StopView>(message)) {
      server->Send(client,
                   {.binary = false, .bytes = std::make_shared<const std::string>("stop " + std::to_string(std::get<StopView>(message).seq))});
    }
  }
  void OnClose(ClientId client) override {
    Record([&] { open.erase(client), closed.push_back(client); });
  }

  // Waits, for up to 8 s, until the condition on this object holds.
  template <typename Condition>
  bool WaitFor(const Condition& condition) {
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(8), condition);
  }

  std::mutex mutex;
  std::condition_variable changed;
  std::set<ClientId> open;
  std::vector<ClientId> closed;
  std::map<ClientId, int> messages;
  ClientId newest = 0;
  bool echo = true, throws = false;
  Server* server = nullptr;

 private:
  template <typename Change>
  void Record(const Change& change) {
    const std::lock_guard lock(mutex);
    change();
    changed.notify_all();
  }
};

class RecordingData : public DataSource {
 public:
  DataReply Get(const std::string& path, const std::string& query) override {
    const std::lock_guard lock(mutex);
    asked.push_back(path + (query.empty() ? "" : "?" + query));
    if (path == "text") return {.status = 200, .content_type = "text/plain", .body = "hello", .file = {}};
    if (path == "cached") return {.status = 200, .content_type = "text/plain", .body = "kept", .file = {}, .cache = true};
    if (path == "kept")
      return {
          .status = 200, .content_type = "text/plain", .body = "", .file = {}, .etag = "a1", .kept = std::make_shared<const std::string>("shared")};
    if (path == "file") return {.status = 200, .content_type = "model/gltf-binary", .body = "", .file = file};
    if (path == "folder") return {.status = 200, .content_type = "text/plain", .body = "", .file = "/tmp"};
    if (path == "throws") throw std::runtime_error("<b>secret reason</b>");
    if (path == "split") return {.status = 200, .content_type = "text/plain\r\nSet-Cookie: a=b", .body = "x", .file = {}};
    return DataReply::NotFound("no such thing");
  }
  DataReply Put(const std::string& path, const std::string& body, const std::string& if_match) override {
    const std::lock_guard lock(mutex);
    saved[path] = body;
    matched.push_back(if_match);
    return {.status = 204, .content_type = "", .body = "", .file = {}, .etag = "new"};
  }
  std::mutex mutex;
  std::vector<std::string> asked;
  std::map<std::string, std::string> saved;
  std::vector<std::string> matched;
  std::filesystem::path file;
};

class ServerTest : public ::testing::Test {
 protected:
  void SetUp() override { Start({}); }
  // A server with these options instead, and a login where all may look.
  void Start(ServerOptions options) {
    server_.reset();
    options.assets = {{"/", "text/html; charset=utf-8", "<p>front end</p>"}, {"/app.js", "text/javascript; charset=utf-8", "let a = 1;"}};
    server_ = std::make_unique<Server>(options, handler_, data_);
    handler_.server = server_.get();
    host_ = "127.0.0.1:" + std::to_string(server_->port());
    origin_ = "http://" + host_;
    if (options.rights == ServerOptions().rights) cookie_ = Login();
  }
  void TearDown() override { server_.reset(); }

  std::string LinkTarget(Right right = Right::kView) const {
    const std::string link = server_->LaunchLink(right);
    return link.substr(link.find("/?token="));
  }
  // Uses up the launch link; the value of the Cookie header.
  std::string Login(Right right = Right::kView) {
    const auto reply = Ask("GET " + LinkTarget(right), "");
    if (!reply || reply->status != 303) return "";
    const std::string& set = reply->headers.at("set-cookie");
    return set.substr(0, set.find(';'));
  }
  // A request's text. start: "GET /path"; extra: lines that end in \r\n.
  std::string Request(const std::string& start, const std::string& cookie, const std::string& extra = "", const std::string& body = "") const {
    return start + " HTTP/1.1\r\nHost: " + host_ + "\r\n" + (cookie.empty() ? "" : "Cookie: " + cookie + "\r\n") + extra +
           (body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n") + "\r\n" + body;
  }
  // On a connection of its own.
  std::optional<HttpReply> Ask(const std::string& start, const std::string& cookie, const std::string& extra = "", const std::string& body = "") {
    return AskRaw(Request(start, cookie, extra, body), start.starts_with("HEAD"));
  }
  std::optional<HttpReply> AskRaw(const std::string& bytes, bool head = false) {
    RawClient client(server_->port());
    client.Send(bytes);
    return client.ReadReply(head);
  }
  int Status(const std::optional<HttpReply>& reply) const { return reply ? reply->status : 0; }
  std::string UpgradeRequest(const std::string& cookie, const std::string& origin, const std::string& path = "/ws") const {
    return Request("GET " + path, cookie,
                   (origin.empty() ? "" : "Origin: " + origin + "\r\n") +
                       "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n");
  }
  // Null when it was refused. `greet`: says hello and waits until it is known.
  std::unique_ptr<RawClient> OpenWebsocket(const std::string& cookie, bool greet = true, int receive_buffer = 0) {
    auto client = std::make_unique<RawClient>(server_->port(), receive_buffer);
    client->Send(UpgradeRequest(cookie, origin_));
    if (Status(client->ReadReply(true)) != 101) return nullptr;
    if (!greet) return client;
    const size_t before = Opened();
    client->Send(MakeFrame(1, kHello));
    if (!handler_.WaitFor([&] { return handler_.open.size() + handler_.closed.size() > before; })) return nullptr;
    return client;
  }
  // The server's close code, skipping other frames; 0 when the connection ended without.
  static int CloseCode(RawClient& client) {
    for (;;) {
      const auto frame = client.ReadFrame();
      if (!frame) return 0;
      if (frame->opcode == 8) return frame->close_code();
    }
  }
  // Whether this client still gets answers.
  static bool IsServed(RawClient& client) {
    client.Send(MakeFrame(1, R"({"type":"stop","seq":7})"));
    for (;;) {
      const auto frame = client.ReadFrame();
      if (!frame) return false;
      if (frame->payload == "stop 7") return true;
    }
  }
  size_t Opened() {
    const std::lock_guard lock(handler_.mutex);
    return handler_.open.size() + handler_.closed.size();
  }

  static constexpr const char* kHello = R"({"type":"hello","version":1})";
  RecordingHandler handler_;
  RecordingData data_;
  std::unique_ptr<Server> server_;
  std::string host_, origin_, cookie_;
};

}  // namespace skyquilt::viewer
