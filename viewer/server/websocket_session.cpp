#include "viewer/server/websocket_session.h"

#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <variant>

#include "core/base/log.h"
#include "viewer/protocol/messages.h"
#include "viewer/protocol/replies.h"
#include "viewer/server/token_bucket.h"
//
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>

namespace skyquilt::viewer::server {
namespace {

namespace websocket = beast::websocket;
using websocket::close_code;

constexpr int kMaxBadMessages = 10;  // in a row
// Of frames that are no complete message (empty fragments, pongs): a client that sends more is not a browser.
constexpr uint64_t kMaxBytesPerMessage = 64U << 10U;
constexpr double kCloseS = 5.0;  // for the client's answer to a close

class WebsocketSession : public std::enable_shared_from_this<WebsocketSession> {
 public:
  using Clock = std::chrono::steady_clock;

  WebsocketSession(ServerState& server, Stream stream, UpgradeRequest request, ConnectionSlot slot)
      : server_(server),
        websocket_(std::move(stream)),
        timer_(websocket_.get_executor()),
        request_(std::move(request)),
        slot_(std::move(slot)),
        id_(server.next_client++),
        opened_(Clock::now()),
        rate_(server.options.max_messages_per_s, opened_) {
    ++server_.websockets;
  }
  // Usually finished already. An operation that threw has released this object otherwise.
  ~WebsocketSession() {
    try {
      Finish();
    } catch (const std::exception& error) {
      base::LogError("viewer: client {}: {}", id_, error.what());
    }
  }
  WebsocketSession(const WebsocketSession&) = delete;
  WebsocketSession& operator=(const WebsocketSession&) = delete;

  void Start(const std::string& host) {
    const std::weak_ptr<WebsocketSession> weak = weak_from_this();
    slot_->SetClose([weak] {
      if (const auto self = weak.lock()) self->Finish();
    });
    slot_->Set(Standing::kBusy);
    queue_ = std::make_shared<SendQueue>(server_.options.max_queued_bytes, [weak, executor = websocket_.get_executor()] {
      asio::post(executor, [weak] {
        if (const auto self = weak.lock()) self->OnQueueChanged();
      });
    });
    Lowest().expires_never();  // the WebSocket has timeouts of its own
    websocket::stream_base::timeout timeout{};
    timeout.handshake_timeout = Seconds(server_.options.handshake_s);
    timeout.idle_timeout = Seconds(server_.options.idle_s);
    timeout.keep_alive_pings = true;
    websocket_.set_option(timeout);
    websocket_.set_option(websocket::stream_base::decorator([headers = SecurityHeaders(host)](websocket::response_type& response) {
      for (const auto& [name, value] : headers) response.set(name, value);
    }));
    websocket_.read_message_max(kMaxMessageBytes + 1);
    websocket_.auto_fragment(false);
    websocket_.control_callback([this](websocket::frame_type kind, beast::string_view) {
      if (kind == websocket::frame_type::close || rate_.Take(Clock::now())) return;
      // Not from within Beast's reading.
      asio::post(websocket_.get_executor(), [self = shared_from_this()] { self->CloseForRate(); });
    });
    ArmTimer();
    websocket_.async_accept(request_, [self = shared_from_this()](const beast::error_code& error) {
      if (self->Failed(error)) return;
      self->request_ = {};
      self->accepted_ = true;
      self->Read();
    });
  }

 private:
  Stream& Lowest() { return beast::get_lowest_layer(websocket_); }

  void Read() {
    websocket_.async_read(buffer_, [self = shared_from_this()](const beast::error_code& error, size_t) {
      // While closing, the answer of async_close ends the session.
      if (self->closing_) return;
      if (self->Failed(error)) return;
      self->OnBytes();
      self->buffer_.consume(self->buffer_.size());
      if (!self->closing_ && !self->finished_) self->Read();
    });
  }

  void OnBytes() {
    received_before_ = Lowest().rate_policy().received();
    if (!rate_.Take(Clock::now())) {
      CloseForRate();
    } else if (websocket_.got_binary()) {
      Close(close_code::unknown_data, "only text is understood");
    } else {
      OnText(beast::buffers_to_string(buffer_.data()));
    }
  }

  void OnText(const std::string& text) {
    std::optional<ClientMessage> message;
    std::string finding = "this message cannot be read";
    try {
      message = ParseClientMessage(text);
    } catch (const std::exception& error) {
      finding = error.what();
    }
    if (!greeted_) {
      Greet(message ? std::get_if<Hello>(&*message) : nullptr);
      return;
    }
    if (message && std::holds_alternative<Hello>(*message)) {
      message.reset();
      finding = "hello was said already";
    }
    if (!message) {
      queue_->Push({.binary = false, .bytes = std::make_shared<const std::string>(ErrorText(finding))});
      if (++bad_messages_ >= kMaxBadMessages) Close(close_code::policy_error, "too many messages that are not allowed");
      return;
    }
    bad_messages_ = 0;
    Guarded([&] { server_.handler.OnMessage(id_, std::move(*message)); });
  }

  void Greet(const Hello* hello) {
    if (hello == nullptr) {
      Close(close_code::protocol_error, "the first message must be hello");
    } else if (hello->version != kProtocolVersion) {
      Close(close_code::protocol_error, "this page is of another version than the viewer: reload it");
    } else {
      greeted_ = true;
      server_.clients.Add(id_, queue_);
      known_ = true;
      Guarded([&] { server_.handler.OnOpen(id_); });
    }
  }

  template <typename Call>
  void Guarded(const Call& call) {
    try {
      call();
    } catch (const std::exception& error) {
      base::LogError("viewer: client {}: {}", id_, error.what());
      Close(close_code::internal_error, "the viewer failed; its terminal says why");
    }
  }

  void OnQueueChanged() {
    queue_->BeginLook();
    if (finished_ || closing_) return;
    if (queue_->overflowed()) {
      base::LogWarning("viewer: client {} does not read what is sent to it and is disconnected", id_);
      Finish();
    } else if (!writing_) {
      WriteNext();
    }
  }

  void WriteNext() {
    std::optional<OutMessage> next = queue_->Next();
    if (!next) return;
    under_way_ = std::move(next->bytes);
    writing_ = true;
    progressed_ = Clock::now();
    websocket_.binary(next->binary);
    websocket_.async_write(asio::buffer(*under_way_), [self = shared_from_this()](const beast::error_code& error, size_t) {
      self->writing_ = false;
      self->under_way_.reset();
      // While closing, the answer of async_close ends the session.
      if (self->closing_ || self->Failed(error)) return;
      self->WriteNext();
    });
  }

  void CloseForRate() { Close(close_code::policy_error, "too many messages in a second"); }

  // Tells the client why, then ends.
  void Close(close_code code, const char* reason) {
    if (finished_ || closing_) return;
    if (!accepted_) {
      Finish();
      return;
    }
    base::LogDebug("viewer: client {} is disconnected: {}", id_, reason);
    closing_ = true;
    closing_since_ = Clock::now();
    Leave();
    websocket_.async_close({code, reason}, [self = shared_from_this()](const beast::error_code&) { self->Finish(); });
  }

  bool Failed(const beast::error_code& error) {
    if (error) Finish();
    return finished_;
  }

  // Ends the connection at once. Its running operations fail soon after, which releases this object.
  void Finish() {
    if (finished_) return;
    finished_ = true;
    --server_.websockets;
    slot_.reset();
    Leave();
    timer_.cancel();
    Lowest().close();
  }

  // From now on nothing is sent to this client or heard from it.
  void Leave() {
    if (queue_ != nullptr) queue_->Close();
    if (!std::exchange(known_, false)) return;
    server_.clients.Remove(id_);
    try {
      server_.handler.OnClose(id_);
    } catch (const std::exception& error) {
      base::LogError("viewer: client {}: {}", id_, error.what());
    }
  }

  // What Beast has no timeouts for is looked at from time to time.
  void ArmTimer() {
    const double shortest = std::min(server_.options.handshake_s, server_.options.write_stall_s);
    timer_.expires_after(Seconds(std::clamp(shortest / 4.0, 0.02, 1.0)));
    timer_.async_wait([weak = weak_from_this()](const beast::error_code& cancelled) {
      const auto self = weak.lock();
      if (cancelled || self == nullptr || self->finished_) return;
      self->OnTimer();
      if (!self->finished_) self->ArmTimer();
    });
  }

  void OnTimer() {
    const Clock::time_point now = Clock::now();
    const auto& traffic = Lowest().rate_policy();
    if (traffic.sent() != sent_before_) {
      sent_before_ = traffic.sent();
      progressed_ = now;
    }
    if (closing_) {
      if (now - closing_since_ > Seconds(std::min(kCloseS, server_.options.handshake_s))) Finish();
    } else if (writing_ && now - progressed_ > Seconds(server_.options.write_stall_s)) {
      base::LogWarning("viewer: client {} does not read what is sent to it and is disconnected", id_);
      Finish();
    } else if (!greeted_ && now - opened_ > Seconds(server_.options.handshake_s)) {
      Close(close_code::protocol_error, "the first message must be hello, and come at once");
    } else if (traffic.received() - received_before_ > kMaxBytesPerMessage) {
      Close(close_code::policy_error, "too many bytes without a message");
    }
  }

  ServerState& server_;
  websocket::stream<Stream, false> websocket_;  // without compression
  asio::steady_timer timer_;
  UpgradeRequest request_;
  std::optional<ConnectionSlot> slot_;
  const ClientId id_;
  beast::flat_buffer buffer_;
  std::shared_ptr<SendQueue> queue_;
  std::shared_ptr<const std::string> under_way_;
  const Clock::time_point opened_;
  Clock::time_point progressed_{}, closing_since_{};
  TokenBucket rate_;
  uint64_t sent_before_ = 0, received_before_ = 0;
  int bad_messages_ = 0;
  bool known_ = false;  // to the handler
  bool accepted_ = false, greeted_ = false, writing_ = false, closing_ = false, finished_ = false;
};

}  // namespace

void StartWebsocketSession(ServerState& server, Stream stream, UpgradeRequest request, const std::string& host, ConnectionSlot slot) {
  std::make_shared<WebsocketSession>(server, std::move(stream), std::move(request), std::move(slot))->Start(host);
}

}  // namespace skyquilt::viewer::server
