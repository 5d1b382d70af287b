// Accepts connections.
#pragma once

#include <cstdint>
#include <string>

#include "viewer/server/net.h"
//
#include <boost/asio/steady_timer.hpp>

namespace skyquilt::viewer::server {

struct ServerState;

class Listener {
 public:
  // Binds. port 0: a free one. Throws base::UsageError when that is not possible.
  Listener(asio::io_context& io, const std::string& address, int port);

  // The numeric address in its usual form, and the port that was chosen.
  std::string address() const;
  int port() const;

  void Start(ServerState& server);
  // On the server's thread.
  void Close();

 private:
  void Accept();

  tcp::acceptor acceptor_;
  asio::steady_timer pause_;
  ServerState* server_ = nullptr;
};

}  // namespace skyquilt::viewer::server
