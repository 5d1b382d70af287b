// The viewer's web server: HTTP and one WebSocket on one port, for browsers on this machine. It knows nothing of scenes.
// Security: bound to 127.0.0.1 unless asked otherwise; Host must be in the allow-list (against DNS rebinding), Origin must be the server's own on
// the WebSocket's upgrade and on PUT; a one-time token in the launch link is exchanged for an HttpOnly, SameSite=Strict cookie; tokens and cookies
// are compared in constant time; every answer carries CSP, nosniff, no-referrer, no CORS; sizes, rates, clients and times are limited. Each link
// gives one right (Right), which its session keeps.
//   GET  /?token=T      303 to / with the cookie; the token is used up, and a new link is printed
//   GET  /              index.html;  other assets by their fixed names
//   GET  /data/<path>   DataSource::Get;  PUT /data/<path>: DataSource::Put (body up to 1 MiB, below tour/assets/ 50 MiB)
//   GET  /data/rights.json   what this session may change
//   GET  /ws            WebSocket (text from the client, up to kMaxMessageBytes)
// Without a valid cookie everything but /?token= is answered with 403 and a page that says how to get a link.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "viewer/protocol/messages.h"

namespace skyquilt::viewer {

using ClientId = uint64_t;

// What a session may do. Each includes those before it.
enum class Right {
  kPlay,  // look and play: nothing that writes
  kView,  // and save measurements, control points and camera paths
  kEdit,  // and change the tour and upload its models and pictures
};

struct OutMessage {
  bool binary = false;
  std::shared_ptr<const std::string> bytes;
};

// What a browser asks by WebSocket. Called on the server's thread: must return at once.
class ClientHandler {
 public:
  virtual ~ClientHandler() = default;
  // The connection is open and said hello in the right version.
  virtual void OnOpen(ClientId client) = 0;
  // Any message but Hello.
  virtual void OnMessage(ClientId client, ClientMessage message) = 0;
  virtual void OnClose(ClientId client) = 0;
};

struct DataReply {
  int status = 200;
  std::string content_type;
  std::string body;            // or
  std::filesystem::path file;  // sent from disk when not empty
  bool cache = false;          // may be kept by the browser for this page's lifetime: its URL changes with its content
  std::string etag = {};       // header ETag, without quotes; empty: none
  // Sent instead of `body` when not null: a file that the source keeps, so that all connections that send it share one copy.
  std::shared_ptr<const std::string> kept = {};

  const std::string& Content() const { return kept != nullptr ? *kept : body; }
  static DataReply NotFound(const std::string& reason) {
    return {.status = 404, .content_type = "text/plain; charset=utf-8", .body = reason, .file = {}};
  }
};

// Files that are uploaded are kept in memory until they are checked: this, times max_uploads.
constexpr size_t kMaxUploadBytes = 50U << 20U;

// What a browser asks by HTTP below /data/. Called on a thread of its own, one call at a time.
class DataSource {
 public:
  virtual ~DataSource() = default;
  // path: without the leading "/data/", 1 to 200 characters of [A-Za-z0-9_./-] without ".." or "//"; query: the URL's part after '?', unparsed, up to
  // 100 characters. Must look the path up in a table and never use it to open a file. Exceptions become status 500 and are logged.
  virtual DataReply Get(const std::string& path, const std::string& query) = 0;
  // if_match: the tags in the header If-Match without quotes, separated by spaces; empty when there is none or it is "*". One of them must be the
  // present file's etag.
  virtual DataReply Put(const std::string& path, const std::string& body, const std::string& if_match) = 0;
};

struct Asset {
  std::string path;  // "/", "/app.js"
  std::string content_type;
  std::string body;
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  int port = 0;  // 0: a free one
  std::vector<Asset> assets = {};
  // Names that the Host header may have beside the address, localhost and 127.0.0.1, all with the port.
  std::vector<std::string> extra_hosts = {};
  std::vector<Right> rights = {Right::kView};  // one launch link for each
  int max_uploads = 2;                         // at a time; others are answered with 503
  int max_clients = 16;                        // WebSockets
  int max_connections = 128;                   // sockets
  size_t max_queued_bytes = 32U << 20U;        // unsent messages of one client, above which it is disconnected
  double handshake_s = 10.0;                   // until a request is complete and for its answer to make progress
  double idle_s = 300.0;                       // without a message or a pong
  double keep_alive_s = 30.0;                  // between two requests of one connection
  double slow_answer_s = 30.0;                 // after which an HTTP answer must have gone out at this rate since it began:
  double min_answer_bytes_per_s = 16384.0;
  double write_stall_s = 30.0;   // for a client that does not read what is sent to it
  int max_messages_per_s = 200;  // per client; above it is disconnected
};

class Server {
 public:
  // Binds and starts its threads. Throws base::UsageError when the port is taken or the address is not one of this machine.
  // handler and data must outlive it.
  Server(const ServerOptions& options, ClientHandler& handler, DataSource& data);
  // Closes all connections and ends the threads.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  int port() const;
  // "http://127.0.0.1:PORT/?token=...": works once and gives this right, one of ServerOptions::rights. `on_link_used` is called on the server's
  // thread with the next one of the same right.
  std::string LaunchLink(Right right) const;
  void OnLinkUsed(std::function<void(Right right, const std::string& next_link)> on_link_used);

  // Thread-safe. Unknown clients are ignored.
  void Send(ClientId client, OutMessage message);
  // Bytes that are queued for a client and not yet on their way; 0 for unknown clients. Thread-safe.
  size_t QueuedBytes(ClientId client) const;
  int clients() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::viewer
