#include "viewer/server/server.h"

#include <exception>
#include <mutex>
#include <thread>

#include "core/base/log.h"
#include "viewer/server/listener.h"
#include "viewer/server/server_state.h"
//
#include <boost/asio/post.hpp>

namespace skyquilt::viewer {

struct Server::Impl {
  Impl(const ServerOptions& server_options, ClientHandler& handler, DataSource& data)
      : options(server_options),
        io(std::make_unique<boost::asio::io_context>(1)),
        listener(std::make_unique<server::Listener>(*io, options.address, options.port)),
        address(listener->address()),
        port(listener->port()),
        access("skyquilt_" + std::to_string(port), options.rights),
        state{.options = options,
              .handler = handler,
              .access = access,
              .router = {options.assets, {address, port, options.extra_hosts}, access, [this](Right right) { LinkUsed(right); }},
              .connections = server::Connections(options.max_connections),
              .clients = {},
              .data = {data, [this](std::function<void()> run) { boost::asio::post(*io, std::move(run)); }}} {
    listener->Start(state);
    thread = std::thread([this] { Run(); });
  }

  ~Impl() {
    boost::asio::post(*io, [this] {
      listener->Close();
      state.connections.CloseAll();
      io->stop();
    });
    thread.join();
    state.data.Stop();
    // Callbacks that are still queued hold connections, which use `state`.
    listener.reset();
    io.reset();
  }

  void Run() {
    for (;;) {
      try {
        io->run();
        return;
      } catch (const std::exception& error) {
        // One connection's trouble (out of memory, say) must not end the service for the others.
        base::LogError("viewer: {}", error.what());
      }
    }
  }

  std::string Link(Right right) const {
    return "http://" + server::LinkHost(address, options.extra_hosts) + ":" + std::to_string(port) + "/?token=" + access.token(right);
  }

  void LinkUsed(Right right) {
    std::function<void(Right, const std::string&)> call;
    {
      const std::lock_guard lock(mutex);
      call = on_link_used;
    }
    try {
      if (call) call(right, Link(right));
    } catch (const std::exception& error) {
      base::LogError("viewer: {}", error.what());
    }
  }

  const ServerOptions options;
  std::unique_ptr<boost::asio::io_context> io;
  std::unique_ptr<server::Listener> listener;
  const std::string address;
  const int port;
  server::Access access;
  std::mutex mutex;
  std::function<void(Right, const std::string&)> on_link_used;
  server::ServerState state;
  std::thread thread;
};

Server::Server(const ServerOptions& options, ClientHandler& handler, DataSource& data) : impl_(std::make_unique<Impl>(options, handler, data)) {}

Server::~Server() = default;

int Server::port() const {
  return impl_->port;
}

std::string Server::LaunchLink(Right right) const {
  return impl_->Link(right);
}

void Server::OnLinkUsed(std::function<void(Right right, const std::string& next_link)> on_link_used) {
  const std::lock_guard lock(impl_->mutex);
  impl_->on_link_used = std::move(on_link_used);
}

void Server::Send(ClientId client, OutMessage message) {
  if (const auto queue = impl_->state.clients.Find(client)) queue->Push(std::move(message));
}

size_t Server::QueuedBytes(ClientId client) const {
  const auto queue = impl_->state.clients.Find(client);
  return queue == nullptr ? 0 : queue->waiting_bytes();
}

int Server::clients() const {
  return impl_->state.clients.size();
}

}  // namespace skyquilt::viewer
