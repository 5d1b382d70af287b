// Renders for all connected browsers on the thread that runs it (the one that may use MPI): picks and other queries, small frames of everybody first,
// then larger ones in turn. A newer view of a client replaces its older one within one batch of rays (about 10 ms).
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "coordinator/project/project.h"
#include "coordinator/project/run_options.h"
#include "core/comm/communicator.h"
#include "viewer/data/project_data.h"
#include "viewer/server/server.h"

namespace skyquilt::viewer {

struct EngineInput {
  comm::Communicator& comm;
  coordinator::Project project;
  std::optional<coordinator::Project> before;
  coordinator::RunOptions run;      // threads and memory; with `before`, each scene gets half of the memory
  std::string exposure = "normal";  // as `render --exposure`
  bool plain_surround = true;       // of exact frames, see products.plain_surround
  bool verbose = false, quiet = false;
};

// Sends to a client; null bytes are never sent. `queued` returns the bytes that wait for it.
struct Outbox {
  std::function<void(ClientId, OutMessage)> send;
  std::function<size_t(ClientId)> queued;
};

class Engine : public ClientHandler {
 public:
  Engine(const EngineInput& input, ProjectData& data);
  ~Engine() override;

  // Loads the scene, then serves until base::CancelRequested. Looks once a second whether scene.h5 (or surface.json, metrics.json) is a new file:
  // loads it and tells the clients. A scene that cannot be loaded is reported to the clients, and the service goes on without exact frames.
  void Run(const Outbox& outbox);

  void OnOpen(ClientId client) override;
  void OnMessage(ClientId client, ClientMessage message) override;
  void OnClose(ClientId client) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skyquilt::viewer
