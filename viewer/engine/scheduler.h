// Decides what is rendered next for whom, a batch of rays at a time. In order: picks, other small questions, first passes of views, then further
// passes and large questions in turn; last the views of clients that do not take their frames. Within each, clients in turn. Whatever is passed over
// eight times while it has work gets a turn, so that nothing waits for ever. No clocks and no threads: what happens depends only on the calls.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "viewer/engine/engine.h"
#include "viewer/engine/frame_cache.h"
#include "viewer/engine/frame_encoder.h"
#include "viewer/engine/frame_gate.h"
#include "viewer/engine/frame_job.h"
#include "viewer/engine/renderer.h"
#include "viewer/protocol/replies.h"

namespace skyquilt::viewer {

// Makes the query of a question (PickRequest to ErrorMapRequest). May throw BadMessage.
using QueryMaker = std::function<std::unique_ptr<Query>(const ClientMessage&)>;

class Scheduler {
 public:
  static constexpr size_t kCacheBytes = 12U << 20U;
  static constexpr size_t kMaxQuestions = 32;  // per client

  // All must outlive it.
  Scheduler(Renderer& renderer, FrameEncoder& encoder, QueryMaker make_query, Outbox outbox);

  // What clients are told of the engine; the number of clients is filled in. new_scene: views and questions of the old one are dropped. Must be
  // called when the renderer's scenes change, before any other call.
  void SetState(EngineState state, bool new_scene);
  const EngineState& state() const { return state_; }

  void Open(ClientId client);
  void Close(ClientId client);
  void Handle(ClientId client, const ClientMessage& message);
  // Sends what is ready, then renders one batch of rays. False: nothing was left to do. Errors of one client's work are told to that client; throws
  // only base::Interrupted.
  bool Step();

 private:
  // By urgency.
  enum Level : size_t { kPick, kSmallQuestion, kFirstPass, kInTurn, kNotTaken, kLevels };
  struct Question {
    uint32_t id = 0;
    Level level = kSmallQuestion;
    std::unique_ptr<Query> query;
    double told = 0.0;  // fraction that the client knows
  };
  struct Client {
    std::optional<FrameJob> job;
    std::optional<uint32_t> last_seq;  // of any view
    std::optional<uint32_t> wanted;    // seq whose frames it still wants
    FrameGate gate;
    std::vector<Question> questions;
    // Turns in which its view and its questions had their last batch: who waits longest is next.
    uint64_t view_served = 0;
    std::array<uint64_t, kLevels> question_served{};
    std::set<Which> told_why_not;
  };
  // A pass that is being encoded.
  struct Encoding {
    ClientId client = 0;
    uint32_t seq = 0;
    int pass = 0;
    std::string key;
    uint64_t scene = 0;
  };
  struct Turn {
    ClientId client = 0;
    std::optional<size_t> question;  // index; none: the view
    uint64_t served = 0;
  };

  void Send(ClientId client, std::string text);
  void SendState();
  void Show(ClientId id, Client& client, const ViewRequest& view);
  void Ask(ClientId id, Client& client, const ClientMessage& message, uint32_t question_id, Level level);
  std::array<std::optional<Turn>, kLevels> Turns() const;
  Level LevelOfView(const Client& client) const;
  std::optional<Level> Choose(const std::array<std::optional<Turn>, kLevels>& turns);
  void RenderView(ClientId id, Client& client);
  void StepQuestion(ClientId id, Client& client, size_t index);
  void UseCache(Client& client);
  bool Deliver();

  Renderer& renderer_;
  FrameEncoder& encoder_;
  QueryMaker make_query_;
  Outbox outbox_;
  EngineState state_;
  uint64_t scene_ = 0;  // counts the scenes
  FrameCache cache_{kCacheBytes};
  std::map<ClientId, Client> clients_;
  std::map<uint64_t, Encoding> encoding_;  // by ticket
  uint64_t turn_ = 0;
  std::array<int, kLevels> passed_over_{};
};

}  // namespace skyquilt::viewer
