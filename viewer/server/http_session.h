// One connection that speaks HTTP, until it is closed or becomes a WebSocket.
#pragma once

#include "viewer/server/net.h"
#include "viewer/server/server_state.h"

namespace skyquilt::viewer::server {

// Takes the connection, unless there is no room. It keeps itself alive.
void StartHttpSession(ServerState& server, tcp::socket socket);

}  // namespace skyquilt::viewer::server
