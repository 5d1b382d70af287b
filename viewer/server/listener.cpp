#include "viewer/server/listener.h"

#include <fcntl.h>

#include <exception>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "viewer/server/http_session.h"

namespace skyquilt::viewer::server {
namespace {

[[noreturn]] void ThrowListenError(const std::string& address, int port, const boost::system::error_code& error) {
  const std::string number = std::to_string(port);
  if (error == asio::error::address_in_use) {
    throw base::UsageError("port " + number + " of " + address +
                           " is in use by another program, perhaps another viewer: choose another with --port, or leave --port out for a free one");
  }
  if (error == asio::error::access_denied) {
    throw base::UsageError("port " + number + " needs special rights: choose one above 1023 with --port, or leave --port out for a free one");
  }
  if (error == std::errc::address_not_available) {
    throw base::UsageError(address + " is not an address of this machine: --listen needs one of its own, or 0.0.0.0 for all");
  }
  throw base::UsageError("cannot listen on " + address + ", port " + number + ": " + error.message());
}

void CloseOnExec(int descriptor) {
  // Programs that are started later must not keep the connection open.
  fcntl(descriptor, F_SETFD, FD_CLOEXEC);
}

}  // namespace

Listener::Listener(asio::io_context& io, const std::string& address, int port) : acceptor_(io), pause_(io) {
  if (port < 0 || port > 65535) throw base::UsageError("--port " + std::to_string(port) + ": a port is a number from 1 to 65535");
  boost::system::error_code error;
  const auto numeric = asio::ip::make_address(address == "localhost" ? "127.0.0.1" : address, error);
  if (error)
    throw base::UsageError("--listen " + address + ": give a numeric address of this machine, for instance 192.168.1.20, or 0.0.0.0 for all");
  const tcp::endpoint endpoint(numeric, static_cast<uint16_t>(port));
  acceptor_.open(endpoint.protocol(), error);
  if (!error) CloseOnExec(acceptor_.native_handle());
  if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) acceptor_.bind(endpoint, error);
  if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
  if (error) ThrowListenError(address, port, error);
}

std::string Listener::address() const {
  return acceptor_.local_endpoint().address().to_string();
}

int Listener::port() const {
  return acceptor_.local_endpoint().port();
}

void Listener::Start(ServerState& server) {
  server_ = &server;
  Accept();
}

void Listener::Close() {
  boost::system::error_code ignored;
  acceptor_.close(ignored);
  pause_.cancel();
}

void Listener::Accept() {
  acceptor_.async_accept([this](const boost::system::error_code& error, tcp::socket socket) {
    if (!acceptor_.is_open()) return;
    if (!error) {
      CloseOnExec(socket.native_handle());
      try {
        StartHttpSession(*server_, std::move(socket));
      } catch (const std::exception& failure) {
        // This connection only (out of memory, say): others must still be accepted.
        base::LogError("viewer: {}", failure.what());
      }
      Accept();
      return;
    }
    if (error == asio::error::connection_aborted) {
      Accept();
      return;
    }
    // Usually no more file descriptors: the connection stays in the system's queue, so trying again at once would only spin.
    base::LogDebug("viewer: cannot accept a connection: {}", error.message());
    server_->connections.CloseOne();
    pause_.expires_after(std::chrono::milliseconds(100));
    pause_.async_wait([this](const boost::system::error_code& cancelled) {
      if (!cancelled && acceptor_.is_open()) Accept();
    });
  });
}

}  // namespace skyquilt::viewer::server
