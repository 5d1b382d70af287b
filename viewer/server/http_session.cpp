#include "viewer/server/http_session.h"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/log.h"
#include "viewer/server/file_reader.h"
#include "viewer/server/websocket_session.h"
//
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/websocket/rfc6455.hpp>

namespace skyquilt::viewer::server {
namespace {

namespace http = beast::http;

constexpr uint32_t kMaxHeaderBytes = 8U << 10U;
constexpr size_t kReadBufferBytes = 16U << 10U;
constexpr std::chrono::seconds kLinger{2};

// The tags in a header If-Match, separated by spaces; empty: none, or any. Ours have neither commas nor spaces.
std::string TagsOf(std::string_view header) {
  if (header == "*") return {};
  std::string tags;
  while (!header.empty()) {
    const size_t comma = std::min(header.find(','), header.size());
    std::string_view tag = header.substr(0, comma);
    header.remove_prefix(std::min(comma + 1, header.size()));
    while (tag.starts_with(' ')) tag.remove_prefix(1);
    while (tag.ends_with(' ')) tag.remove_suffix(1);
    if (tag.starts_with("W/")) tag.remove_prefix(2);
    if (tag.size() >= 2 && tag.front() == '"' && tag.back() == '"') tag = tag.substr(1, tag.size() - 2);
    if (tag.empty()) continue;
    if (!tags.empty()) tags += ' ';
    tags += tag;
  }
  return tags;
}

// One of the uploads that may be under way.
class UploadSlot {
 public:
  explicit UploadSlot(ServerState& server) : server_(server) { ++server_.uploads; }
  ~UploadSlot() { --server_.uploads; }
  UploadSlot(const UploadSlot&) = delete;
  UploadSlot& operator=(const UploadSlot&) = delete;

 private:
  ServerState& server_;
};

// A request is read, routed and answered; then the next one of the same connection.
class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(ServerState& server, tcp::socket socket) : server_(server), stream_(std::move(socket)), buffer_(kReadBufferBytes) {}

  void Start(ConnectionSlot slot) {
    slot_.emplace(std::move(slot));
    BeginRequest();
    ReadHead();
  }

  void Abort() {
    aborted_ = true;
    slot_.reset();
    stream_.close();
  }

 private:
  void BeginRequest() {
    parser_.emplace();
    parser_->header_limit(kMaxHeaderBytes);
    // Only bodies that are welcome are read, and their limit depends on the path (Receive). Beast 1.74 takes "no limit" for 0 here.
    parser_->body_limit(UINT64_MAX);
  }

  // Waits for the first byte of the next request.
  void AwaitRequest() {
    slot_->Set(trusted_ ? Standing::kWaiting : Standing::kStranger);
    BeginRequest();
    if (buffer_.size() > 0) {
      ReadHead();
      return;
    }
    stream_.expires_after(Seconds(server_.options.keep_alive_s));
    stream_.async_read_some(buffer_.prepare(kReadBufferBytes), [self = shared_from_this()](const beast::error_code& error, size_t bytes) {
      if (self->Failed(error)) return;
      self->buffer_.commit(bytes);
      self->ReadHead();
    });
  }

  void ReadHead() {
    // Not extended when bytes arrive: a client that drips them is cut off.
    stream_.expires_after(Seconds(server_.options.handshake_s));
    http::async_read_header(stream_, buffer_, *parser_, [self = shared_from_this()](const beast::error_code& error, size_t) { self->OnHead(error); });
  }

  void OnHead(const beast::error_code& error) {
    if (AnsweredParseError(error) || Failed(error)) return;
    const RequestHead head = Head();
    keep_alive_ = parser_->get().keep_alive();
    without_body_ = head.method == Method::kHead;
    Decision decision = server_.router.Decide(head, Access::Clock::now());
    host_ = decision.host;
    trusted_ = decision.trusted;
    if (trusted_) slot_->Set(Standing::kBusy);
    switch (decision.action) {
      case Action::kAnswer:
        // What is left of a refused request would be taken for the next one.
        if (head.has_body) keep_alive_ = false;
        Send(std::move(decision.answer));
        break;
      case Action::kGetData:
        server_.data.Get(std::move(decision.path), std::move(decision.query),
                         [self = shared_from_this()](DataReply reply) { self->Send(DataAnswer(std::move(reply))); });
        break;
      case Action::kPutData:
        path_ = std::move(decision.path);
        {
          const auto header = parser_->get()[http::field::if_match];
          if_match_ = TagsOf({header.data(), header.size()});
        }
        upload_ = decision.upload;
        Receive();
        break;
      case Action::kOpenWebsocket:
        OpenWebsocket();
        break;
    }
  }

  RequestHead Head() const {
    const auto& request = parser_->get();
    const auto all = [&request](http::field name) {
      std::vector<std::string> values;
      const auto range = request.equal_range(name);
      for (auto it = range.first; it != range.second; ++it) values.emplace_back(it->value());
      return values;
    };
    RequestHead head;
    head.method = request.method() == http::verb::get    ? Method::kGet
                  : request.method() == http::verb::head ? Method::kHead
                  : request.method() == http::verb::put  ? Method::kPut
                                                         : Method::kOther;
    head.target = std::string(request.target());
    head.hosts = all(http::field::host);
    head.origins = all(http::field::origin);
    head.cookies = all(http::field::cookie);
    head.upgrade = beast::websocket::is_upgrade(request);
    head.has_body = !parser_->is_done();
    return head;
  }

  // Refuses a body that is too long before it comes.
  void Receive() {
    const uint64_t limit = upload_ ? kMaxUploadBytes : kMaxDocumentBytes;
    const auto length = parser_->content_length();
    parser_->body_limit(limit);
    if (length && *length > limit) {
      Refuse(413, "the body is too long: at most " + std::to_string(limit >> 20U) + " MiB are taken");
    } else if (upload_ && !length) {
      // Memory is reserved by this length; without it twice as much could be needed while the body grows.
      Refuse(411, "an upload must say its length in the header Content-Length");
    } else if (upload_ && server_.uploads >= server_.options.max_uploads) {
      Answer answer = PlainAnswer(503, "other files are being uploaded: try again in a moment");
      answer.headers.emplace_back("Retry-After", "2");
      Refuse(std::move(answer));
    } else {
      if (upload_) upload_slot_.emplace(server_);
      ContinueThenReadBody();
    }
  }

  // Answers without reading the body.
  void Refuse(Answer answer) {
    if (!parser_->is_done()) keep_alive_ = false;
    Send(std::move(answer));
  }
  void Refuse(int status, const std::string& reason) { Refuse(PlainAnswer(status, reason)); }

  // Clients with a large body may wait to be told that it is welcome.
  void ContinueThenReadBody() {
    if (parser_->is_done() || !beast::iequals(parser_->get()[http::field::expect], "100-continue")) {
      ReadBody();
      return;
    }
    static constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";
    asio::async_write(stream_, asio::buffer(kContinue), [self = shared_from_this()](const beast::error_code& error, size_t) {
      if (!self->Failed(error)) self->ReadBody();
    });
  }

  void ReadBody() {
    if (upload_) {
      received_before_ = stream_.rate_policy().received();
      receive_began_ = std::chrono::steady_clock::now();
      ReadUpload();
      return;
    }
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](const beast::error_code& error, size_t) {
      if (self->AnsweredParseError(error) || self->Failed(error)) return;
      self->Put();
    });
  }

  // Piece by piece: a large file may take its time, as long as it comes.
  void ReadUpload() {
    if (parser_->is_done()) {
      Put();
      return;
    }
    stream_.expires_after(Seconds(server_.options.handshake_s));
    http::async_read_some(stream_, buffer_, *parser_, [self = shared_from_this()](const beast::error_code& error, size_t) {
      if (self->AnsweredParseError(error) || self->Failed(error)) return;
      if (self->IsTooSlow(self->receive_began_, self->stream_.rate_policy().received() - self->received_before_)) {
        base::LogDebug("viewer: a client that uploads too slowly is disconnected");
        self->Abort();
        return;
      }
      self->ReadUpload();
    });
  }

  void Put() {
    server_.data.Put(std::move(path_), std::move(parser_->get().body()), std::move(if_match_), [self = shared_from_this()](DataReply reply) {
      self->upload_slot_.reset();
      self->Send(DataAnswer(std::move(reply)));
    });
  }

  void OpenWebsocket() {
    // A few connections stay free for requests.
    const int max_clients = std::max(1, std::min(server_.options.max_clients, server_.options.max_connections - 4));
    if (server_.websockets >= max_clients) {
      Send(PlainAnswer(503, "too many browsers are connected"));
    } else if (buffer_.size() > 0) {
      keep_alive_ = false;
      Send(PlainAnswer(400, "a client must wait for the answer before it uses the WebSocket"));
    } else {
      StartWebsocketSession(server_, std::move(stream_), parser_->release(), host_, std::move(*slot_));
      slot_.reset();
      aborted_ = true;
    }
  }

  // True when the request is not HTTP or too large, which has been answered.
  bool AnsweredParseError(const beast::error_code& error) {
    if (!error || error == http::error::end_of_stream || error == http::error::partial_message) return false;
    if (error.category() != make_error_code(http::error::end_of_stream).category()) return false;
    keep_alive_ = false;
    without_body_ = false;
    if (error == http::error::header_limit || error == http::error::buffer_overflow) {
      Send(PlainAnswer(431, "the headers are too long"));
    } else if (error == http::error::body_limit) {
      Send(PlainAnswer(413, "the body is too long"));
    } else {
      Send(PlainAnswer(400, "this is not a valid HTTP request"));
    }
    return true;
  }

  // True when the connection has ended. A failed operation is not followed by another, so that this object is released.
  bool Failed(const beast::error_code& error) {
    if (error && !aborted_) Abort();
    return aborted_;
  }

  void Send(Answer answer) {
    if (aborted_) return;
    file_.reset();
    if (!answer.file.empty()) {
      file_ = FileReader::Open(answer.file);
      if (!file_) {
        base::LogWarning("viewer: {} cannot be read any more", answer.file.string());
        answer = PlainAnswer(404, "this file is not there any more");
      }
    }
    answer_ = std::move(answer);
    const uint64_t body_bytes = file_ ? file_->left() : answer_.body == nullptr ? 0 : answer_.body->size();
    const bool empty = without_body_ || answer_.status == 204 || answer_.status == 304;
    if (empty) file_.reset();
    head_ = FormatHead(answer_, body_bytes, keep_alive_, host_);
    head_left_ = head_;
    body_left_ = empty || file_ || answer_.body == nullptr ? std::string_view() : std::string_view(*answer_.body);
    sent_before_ = stream_.rate_policy().sent();
    send_began_ = std::chrono::steady_clock::now();
    SendSome();
  }

  // A client that takes in a large answer, or sends a large file, byte by byte would hold its memory for hours.
  bool IsTooSlow(std::chrono::steady_clock::time_point began, uint64_t bytes) const {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return seconds > server_.options.slow_answer_s && static_cast<double>(bytes) < server_.options.min_answer_bytes_per_s * seconds;
  }

  void SendSome() {
    if (body_left_.empty() && file_ && file_->left() > 0) {
      if (!file_->Read(piece_)) {
        // The length was announced already: only closing tells that something is missing.
        Abort();
        return;
      }
      body_left_ = piece_;
    }
    if (head_left_.empty() && body_left_.empty()) {
      EndAnswer();
      return;
    }
    const std::array<asio::const_buffer, 2> buffers = {asio::buffer(head_left_), asio::buffer(body_left_)};
    stream_.expires_after(Seconds(server_.options.handshake_s));
    stream_.async_write_some(buffers, [self = shared_from_this()](const beast::error_code& error, size_t bytes) {
      if (self->Failed(error)) return;
      const size_t of_head = std::min(bytes, self->head_left_.size());
      self->head_left_.remove_prefix(of_head);
      self->body_left_.remove_prefix(bytes - of_head);
      const bool more = !self->body_left_.empty() || (self->file_ && self->file_->left() > 0);
      if (more && self->IsTooSlow(self->send_began_, self->stream_.rate_policy().sent() - self->sent_before_)) {
        base::LogDebug("viewer: a client that reads its answer too slowly is disconnected");
        self->Abort();
        return;
      }
      self->SendSome();
    });
  }

  void EndAnswer() {
    answer_ = {};
    file_.reset();
    piece_ = {};
    host_.clear();
    if (keep_alive_) {
      AwaitRequest();
      return;
    }
    beast::error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    slot_->Set(Standing::kStranger);
    stream_.expires_after(kLinger);
    Linger();
  }

  // Closing while bytes of the client are unread would make the system drop the answer, too.
  void Linger() {
    buffer_.clear();
    stream_.async_read_some(buffer_.prepare(kReadBufferBytes), [self = shared_from_this()](const beast::error_code& error, size_t) {
      if (!self->Failed(error)) self->Linger();
    });
  }

  ServerState& server_;
  Stream stream_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  std::optional<ConnectionSlot> slot_;
  bool aborted_ = false;
  // Of the current request:
  bool trusted_ = false, keep_alive_ = false, without_body_ = false, upload_ = false;
  std::string host_, path_, if_match_;
  Answer answer_;
  std::string head_, piece_;
  std::string_view head_left_, body_left_;
  std::optional<FileReader> file_;
  uint64_t sent_before_ = 0, received_before_ = 0;  // by this connection, before this answer or body
  std::chrono::steady_clock::time_point send_began_{}, receive_began_{};
  std::optional<UploadSlot> upload_slot_;
};

}  // namespace

void StartHttpSession(ServerState& server, tcp::socket socket) {
  beast::error_code ignored;
  socket.set_option(tcp::no_delay(true), ignored);
  const auto session = std::make_shared<HttpSession>(server, std::move(socket));
  auto slot = server.connections.Admit([weak = std::weak_ptr(session)] {
    if (const auto alive = weak.lock()) alive->Abort();
  });
  if (slot) session->Start(std::move(*slot));
}

}  // namespace skyquilt::viewer::server
