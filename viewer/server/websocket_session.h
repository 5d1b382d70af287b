// One connection that has become a WebSocket.
#pragma once

#include <string>

#include "viewer/server/net.h"
#include "viewer/server/server_state.h"
//
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

namespace skyquilt::viewer::server {

using UpgradeRequest = beast::http::request<beast::http::string_body>;

// Takes over a connection whose request was checked. host: its Host header. It keeps itself alive.
void StartWebsocketSession(ServerState& server, Stream stream, UpgradeRequest request, const std::string& host, ConnectionSlot slot);

}  // namespace skyquilt::viewer::server
