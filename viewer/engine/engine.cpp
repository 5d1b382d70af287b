#include "viewer/engine/engine.h"

#include <chrono>
#include <mutex>
#include <type_traits>
#include <utility>

#include "core/base/cancel.h"
#include "core/base/errors.h"
#include "viewer/engine/frame_encoder.h"
#include "viewer/engine/inbox.h"
#include "viewer/engine/scene_holder.h"
#include "viewer/engine/scheduler.h"
#include "viewer/protocol/replies.h"
#include "viewer/queries/query.h"

namespace skyquilt::viewer {
namespace {

constexpr std::chrono::milliseconds kIdle(20);  // without work, until cancellation is looked at
constexpr std::chrono::seconds kLookEvery(1);   // at the files

}  // namespace

struct Engine::Impl {
  Impl(const EngineInput& input, ProjectData& project_data) : data(project_data), scenes(input, project_data), told(scenes.state()) {}

  std::unique_ptr<Query> MakeQuery(const ClientMessage& message) {
    return std::visit(
        [&](const auto& question) -> std::unique_ptr<Query> {
          using T = std::decay_t<decltype(question)>;
          if constexpr (std::is_same_v<T, PickRequest>) {
            return MakePick(question);
          } else if constexpr (std::is_same_v<T, PhotosAtRequest>) {
            return MakePhotosAt(question, data.survey());
          } else if constexpr (std::is_same_v<T, ProfileRequest>) {
            return MakeProfile(question);
          } else if constexpr (std::is_same_v<T, VolumeRequest>) {
            return MakeVolume(question);
          } else if constexpr (std::is_same_v<T, ErrorMapRequest>) {
            if (scenes.Frame(Which::kMain) == nullptr) throw BadMessage(scenes.WhyNot(Which::kMain));
            return MakeErrorMap(
                question, data.survey(),
                [this](int photo, std::span<const render::Ray> rays, std::span<render::RayColor> out) { scenes.RenderAsPhoto(photo, rays, out); },
                [this](std::string png) { return data.AddPicture(std::move(png)); });
          } else if constexpr (std::is_same_v<T, TrustMapRequest>) {
            return MakeTrustMap(question, scenes.TrustOfMain(), [this](std::string png) { return data.AddPicture(std::move(png)); });
          } else {
            return nullptr;
          }
        },
        message);
  }

  // Tells the clients, and those that will be greeted.
  void Publish(Scheduler& scheduler, bool new_scene) {
    scheduler.SetState(scenes.state(), new_scene);
    Remember(scheduler);
  }
  void Remember(const Scheduler& scheduler) {
    const std::lock_guard lock(greeting);
    told = scheduler.state();
  }

  void LookAtFiles(Scheduler& scheduler) {
    switch (scenes.WhatChanged()) {
      case SceneHolder::Change::kNone:
        break;
      case SceneHolder::Change::kFiles:
        scenes.ReloadData();
        Publish(scheduler, false);
        break;
      case SceneHolder::Change::kScene:
        // Loading takes seconds in which nothing is answered.
        scenes.Unload();
        Publish(scheduler, true);
        scenes.Load();
        Publish(scheduler, true);
        break;
    }
  }

  void Handle(Scheduler& scheduler, const Event& event) {
    if (const auto* message = std::get_if<ClientMessage>(&event.what)) {
      scheduler.Handle(event.client, *message);
    } else if (const auto* opened = std::get_if<Opened>(&event.what)) {
      if (!opened->greeted) Greet(event.client);
      scheduler.Open(event.client);
      Remember(scheduler);
    } else {
      scheduler.Close(event.client);
      Remember(scheduler);
    }
  }

  // Returns whether there was anyone to send it by.
  bool Greet(ClientId client) {
    const std::lock_guard lock(greeting);
    if (!outbox) return false;
    outbox->send(client, {.binary = false, .bytes = std::make_shared<const std::string>(WelcomeText(client, told))});
    return true;
  }

  void SetOutbox(std::optional<Outbox> newer) {
    const std::lock_guard lock(greeting);
    outbox = std::move(newer);
  }

  void Serve(const Outbox& to_clients) {
    FrameEncoder encoder([](const RenderedPass& pass) { return EncodeFrame(pass.header, pass.rgb, pass.depth_m); }, true, [this] { inbox.Wake(); });
    Scheduler scheduler(
        scenes, encoder, [this](const ClientMessage& message) { return MakeQuery(message); }, to_clients);
    scheduler.SetState(scenes.state(), false);
    std::chrono::steady_clock::time_point next_look{};
    while (true) {
      base::ThrowIfCancelled();
      for (const Event& event : inbox.Take()) Handle(scheduler, event);
      if (std::chrono::steady_clock::now() >= next_look) {
        LookAtFiles(scheduler);
        next_look = std::chrono::steady_clock::now() + kLookEvery;
        continue;
      }
      if (!scheduler.Step()) inbox.Wait(kIdle);
    }
  }

  ProjectData& data;
  SceneHolder scenes;
  Inbox inbox;
  // A client is greeted on the server's thread, so that it need not wait while a scene is loaded.
  std::mutex greeting;
  std::optional<Outbox> outbox;
  EngineState told;
};

Engine::Engine(const EngineInput& input, ProjectData& data) : impl_(std::make_unique<Impl>(input, data)) {}

Engine::~Engine() = default;

void Engine::Run(const Outbox& outbox) {
  impl_->SetOutbox(outbox);
  // The server may end before the engine does.
  const struct Leave {
    Impl& impl;
    ~Leave() { impl.SetOutbox({}); }
  } leave{*impl_};
  try {
    impl_->Serve(outbox);
  } catch (const base::Interrupted&) {
    // The normal end.
  }
}

void Engine::OnOpen(ClientId client) {
  impl_->inbox.Put({client, Opened{.greeted = impl_->Greet(client)}});
}

void Engine::OnMessage(ClientId client, ClientMessage message) {
  impl_->inbox.Put({client, std::move(message)});
}

void Engine::OnClose(ClientId client) {
  impl_->inbox.Put({client, Closed{}});
}

}  // namespace skyquilt::viewer
