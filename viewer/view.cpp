#include "viewer/view.h"

#include <csignal>
#include <iostream>

#include "core/base/errors.h"
#include "core/base/log.h"
#include "viewer/assets.h"
#include "viewer/data/project_data.h"
#include "viewer/engine/engine.h"
#include "viewer/server/host_list.h"
#include "viewer/server/server.h"

namespace skyquilt::viewer {
namespace {

bool IsLoopback(const std::string& address) {
  return address.empty() || address == "localhost" || address == "::1" || address.starts_with("127.");
}

std::vector<Asset> Assets(const ViewOptions& options) {
  if (!options.front_end.empty()) return FrontEndFrom(options.front_end);
  std::vector<Asset> assets = FrontEnd();
  if (assets.empty()) {
    throw base::UsageError(
        "this program was built without the viewer's front end, because Node.js or npm's packages were missing. "
        "Install the Debian packages nodejs and npm and build again while the network is up");
  }
  return assets;
}

void PrintLink(const std::string& text, const std::string& link) {
  // The terminal may be gone, and another may have come (a closed pipe; a full disk): each link is tried anew.
  std::cout.clear();
  std::cout << text << "\n\n    " << link << "\n\n" << std::flush;
}

struct LinkText {
  const char* first;
  const char* next;  // after it was opened
};

LinkText TextOf(Right right) {
  switch (right) {
    case Right::kEdit:
      return {"Open this link in a browser on this machine to edit the tour (it works once; Ctrl-C ends the viewer):",
              "The link for editing was opened. For another browser:"};
    case Right::kPlay:
      return {"This link is for looking and playing only, nothing can be changed with it (it works once):",
              "The link for playing was opened. For another browser:"};
    case Right::kView:
      break;
  }
  return {"Open this link in a browser on this machine (it works once; Ctrl-C ends the viewer):", "The link was opened. For another browser:"};
}

}  // namespace

void View(comm::Communicator& comm, const ViewOptions& options) {
  // When the terminal or a pipe that reads our output closes, the viewer goes on.
  std::signal(SIGPIPE, SIG_IGN);
  ServerOptions server_options;
  server_options.assets = Assets(options);
  server_options.port = options.port;
  if (options.edit) server_options.rights = {Right::kEdit, Right::kPlay};
  if (!options.listen.empty()) server_options.address = options.listen == "localhost" ? "127.0.0.1" : options.listen;
  if (!IsLoopback(options.listen)) {
    server_options.extra_hosts = server::OwnHosts();
    base::LogWarning(
        "--listen {}: other machines can reach this viewer, and the connection is not encrypted. Whoever has the link can see the project and change "
        "its measurements{}. Better: keep the default and forward the port, for instance with ssh -t -L 8000:127.0.0.1:8000 host skyquilt view out "
        "--port 8000",
        options.listen, options.edit ? ", and with the link for editing its tour" : "");
  }
  ProjectData data(options.project, options.before);
  Engine engine({.comm = comm,
                 .project = options.project,
                 .before = options.before,
                 .run = options.run,
                 .exposure = options.exposure,
                 .plain_surround = options.plain_surround,
                 .verbose = options.verbose,
                 .quiet = options.quiet},
                data);
  Server server(server_options, engine, data);
  server.OnLinkUsed([](Right right, const std::string& next) { PrintLink(TextOf(right).next, next); });
  for (const Right right : server_options.rights) PrintLink(TextOf(right).first, server.LaunchLink(right));
  try {
    engine.Run({.send = [&server](ClientId client, OutMessage message) { server.Send(client, std::move(message)); },
                .queued = [&server](ClientId client) { return server.QueuedBytes(client); }});
  } catch (const base::Interrupted&) {
    // The normal end.
  }
  base::LogInfo("viewer closed");
}

}  // namespace skyquilt::viewer
