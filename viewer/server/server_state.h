// What all connections of a server share. Its thread only, except where a member's header says more.
#pragma once

#include "viewer/server/access.h"
#include "viewer/server/connections.h"
#include "viewer/server/data_thread.h"
#include "viewer/server/router.h"
#include "viewer/server/send_queue.h"
#include "viewer/server/server.h"

namespace skyquilt::viewer::server {

struct ServerState {
  const ServerOptions& options;
  ClientHandler& handler;
  Access& access;
  Router router;
  Connections connections;
  ClientTable clients;
  DataThread data;
  int websockets = 0;  // open or opening
  int uploads = 0;     // whose bodies are read or being checked
  ClientId next_client = 1;
};

}  // namespace skyquilt::viewer::server
