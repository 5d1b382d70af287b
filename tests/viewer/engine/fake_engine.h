// A scheduler with a renderer that only notes what it is asked, questions that only count, and clients that only collect.
#pragma once

#include <algorithm>
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/base/errors.h"
#include "viewer/engine/scheduler.h"

namespace skyquilt::viewer {

class FakeRenderer : public Renderer {
 public:
  const SceneFrame* Frame(Which project) const override { return project == Which::kMain && ready ? &frame : nullptr; }
  std::string WhyNot(Which /*project*/) const override { return "not there"; }
  size_t Batch(Which /*project*/) const override { return batch; }
  void Render(Which /*project*/, std::span<const render::Ray> rays, std::span<render::RayColor> out) override {
    if (on_render) on_render();
    // Views are told apart by the x of their eyes.
    log.push_back("view" + std::to_string(std::lround(rays.front().origin_enu.x())));
    sizes.push_back(rays.size());
    for (render::RayColor& color : out) {
      color.opacity = 1.0F;
      color.depth_median = 5.0F;
    }
  }
  products::View PhotoView(int photo, int width) const override {
    if (photo != 0) throw BadMessage("no such photo");
    camera::Camera camera{.model = camera::CameraModel::kPinhole, .width = 100, .height = 50, .params = {80.0, 90.0, 50.0, 25.0}};
    return {"photo", camera.Resized(width, width / 2), geo::Rigid3d()};
  }
  FieldAccess Access() override {
    FieldAccess access;
    access.batch = batch;
    return access;
  }
  int Count(const std::string& entry) const { return static_cast<int>(std::count(log.begin(), log.end(), entry)); }

  SceneFrame frame{.cones = false, .min_enu = {-1, -1, -1}, .max_enu = {1, 1, 1}};
  bool ready = true;
  size_t batch = 256;
  std::vector<std::string> log;
  std::vector<size_t> sizes;
  std::function<void()> on_render;
};

// Done after a number of steps.
class FakeQuery : public Query {
 public:
  FakeQuery(std::string name, int steps, std::vector<std::string>* log) : name_(std::move(name)), steps_(steps), log_(log) {}
  bool Step(const FieldAccess& /*access*/) override {
    if (steps_ < 0) throw BadMessage("cannot be answered");
    log_->push_back(name_);
    return ++done_ >= steps_;
  }
  double fraction() const override { return static_cast<double>(done_) / steps_; }
  std::string Reply() const override { return "reply of " + name_; }

 private:
  std::string name_;
  int steps_;
  int done_ = 0;
  std::vector<std::string>* log_;
};

struct SentFrame {
  uint32_t seq = 0, revision = 0;
  int pass = 0;
  bool operator==(const SentFrame&) const = default;
};

inline EngineState Ready(uint32_t revision) {
  EngineState state;
  state.ready = true;
  state.revision = revision;
  return state;
}

inline VolumeRequest Volume(uint32_t id) {
  VolumeRequest request;
  request.id = id;
  return request;
}

struct FakeEngine {
  FakeEngine() {
    for (ClientId client = 1; client <= 4; ++client) scheduler.Open(client);
    scheduler.SetState(Ready(7), true);
    texts.clear();
  }
  static std::string Encode(const RenderedPass& pass) {
    std::string bytes(kFrameHeaderBytes, '\0');
    std::memcpy(&bytes[8], &pass.header.seq, 4);
    std::memcpy(&bytes[12], &pass.header.revision, 4);
    bytes[16] = static_cast<char>(pass.header.pass);
    bytes.append(pass.rgb.begin(), pass.rgb.end());
    return bytes;
  }
  void Send(ClientId client, const OutMessage& message) {
    if (!message.binary) {
      texts[client].push_back(*message.bytes);
      return;
    }
    SentFrame frame;
    std::memcpy(&frame.seq, message.bytes->data() + 8, 4);
    std::memcpy(&frame.revision, message.bytes->data() + 12, 4);
    frame.pass = (*message.bytes)[16];
    frames[client].push_back(frame);
  }
  // 64 x 64: passes of 256, 1024 and 4096 rays.
  static ViewRequest View(uint32_t seq, int eye, int size = 64) {
    ViewRequest view;
    view.seq = seq;
    view.eye_enu.x() = eye;
    view.width = view.height = size;
    return view;
  }
  void Acknowledge(ClientId client) {
    for (const SentFrame& frame : frames[client]) scheduler.Handle(client, FrameAck{frame.seq, frame.pass});
  }
  // Until there is nothing to do. Clients in `acknowledging` take their frames at once.
  void Finish(const std::vector<ClientId>& acknowledging) {
    for (int i = 0; i < 10000 && scheduler.Step(); ++i) {
      for (const ClientId client : acknowledging) Acknowledge(client);
    }
  }
  bool Told(ClientId client, const std::string& part) {
    return std::any_of(texts[client].begin(), texts[client].end(), [&](const std::string& text) { return text.find(part) != std::string::npos; });
  }

  FakeRenderer renderer;
  FrameEncoder encoder{Encode, false};
  int query_steps = 3;
  std::map<ClientId, std::vector<std::string>> texts;
  std::map<ClientId, std::vector<SentFrame>> frames;
  std::map<ClientId, size_t> queued;
  Scheduler scheduler{renderer,
                      encoder,
                      [this](const ClientMessage& message) -> std::unique_ptr<Query> {
                        static const std::map<size_t, std::string> names = {{4, "pick"}, {5, "photos"}, {6, "profile"}, {7, "volume"}, {8, "map"}};
                        const std::string name = names.at(message.index());
                        return std::make_unique<FakeQuery>(name, name == "pick" ? std::min(1, query_steps) : query_steps, &renderer.log);
                      },
                      {.send = [this](ClientId client, const OutMessage& message) { Send(client, message); },
                       .queued = [this](ClientId client) { return queued[client]; }}};
};

}  // namespace skyquilt::viewer
