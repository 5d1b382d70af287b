#include "viewer/engine/scheduler.h"

#include <algorithm>
#include <type_traits>
#include <utility>
#include <variant>

#include "core/base/errors.h"
#include "core/base/log.h"

namespace skyquilt::viewer {
namespace {

constexpr int kPatience = 8;            // turns of others
constexpr double kProgressStep = 0.02;  // between two texts
constexpr size_t kMaxEncodings = 8;     // waiting; then further passes wait too, so that memory stays bounded
constexpr const char* kOurFault = "this could not be rendered because of an error in the program; its log says more";

// Runs a client's work. Its errors become texts for that client; empty: all is well.
std::string ErrorOf(const std::function<void()>& work) {
  try {
    work();
    return {};
  } catch (const base::Interrupted&) {
    throw;
  } catch (const BadMessage& error) {
    return error.what();
  } catch (const base::UsageError& error) {
    base::LogWarning("view: {}", error.what());
    return error.what();
  } catch (const base::InputError& error) {
    base::LogWarning("view: {}", error.what());
    // Without the folder: the browser may be on another machine.
    return error.file().filename().string() + " " + error.finding();
  } catch (const std::exception& error) {
    base::LogError("view: {}", error.what());
    return kOurFault;
  }
}

}  // namespace

Scheduler::Scheduler(Renderer& renderer, FrameEncoder& encoder, QueryMaker make_query, Outbox outbox)
    : renderer_(renderer), encoder_(encoder), make_query_(std::move(make_query)), outbox_(std::move(outbox)) {}

void Scheduler::Send(ClientId client, std::string text) {
  outbox_.send(client, {.binary = false, .bytes = std::make_shared<const std::string>(std::move(text))});
}

void Scheduler::SendState() {
  state_.clients = static_cast<int>(clients_.size());
  const auto text = std::make_shared<const std::string>(EngineText(state_));
  for (const auto& [id, client] : clients_) outbox_.send(id, {.binary = false, .bytes = text});
}

void Scheduler::SetState(EngineState state, bool new_scene) {
  state_ = std::move(state);
  if (new_scene) {
    ++scene_;
    cache_.Clear();
    for (auto& [id, client] : clients_) {
      client.job.reset();
      client.wanted.reset();
      client.gate.Drop();
      client.told_why_not.clear();
      for (const Question& question : client.questions) Send(id, ErrorText("the scene has changed in the meantime; ask again", question.id));
      client.questions.clear();
    }
  }
  SendState();
}

void Scheduler::Open(ClientId client) {
  clients_.try_emplace(client);
  SendState();
}

void Scheduler::Close(ClientId client) {
  if (clients_.erase(client) > 0) SendState();
}

void Scheduler::Handle(ClientId id, const ClientMessage& message) {
  const auto at = clients_.find(id);
  if (at == clients_.end()) return;
  Client& client = at->second;
  std::visit(
      [&](const auto& said) {
        using T = std::decay_t<decltype(said)>;
        if constexpr (std::is_same_v<T, ViewRequest>) {
          Show(id, client, said);
        } else if constexpr (std::is_same_v<T, StopView>) {
          if (client.job && client.job->seq() <= said.seq) client.job.reset();
          if (client.wanted && *client.wanted <= said.seq) {
            client.wanted.reset();
            client.gate.Drop();
          }
        } else if constexpr (std::is_same_v<T, FrameAck>) {
          client.gate.Acknowledge(said.seq, said.pass);
        } else if constexpr (std::is_same_v<T, CancelRequest>) {
          std::erase_if(client.questions, [&](const Question& question) { return question.id == said.id; });
        } else if constexpr (std::is_same_v<T, PickRequest>) {
          Ask(id, client, message, said.id, kPick);
        } else if constexpr (std::is_same_v<T, PhotosAtRequest> || std::is_same_v<T, ProfileRequest>) {
          Ask(id, client, message, said.id, kSmallQuestion);
        } else if constexpr (std::is_same_v<T, VolumeRequest> || std::is_same_v<T, ErrorMapRequest> || std::is_same_v<T, TrustMapRequest>) {
          Ask(id, client, message, said.id, kInTurn);
        }
      },
      message);
}

void Scheduler::Show(ClientId id, Client& client, const ViewRequest& view) {
  if (client.last_seq && view.seq <= *client.last_seq) {
    Send(id, ErrorText("view: seq must be larger than that of the view before"));
    return;
  }
  client.last_seq = view.seq;
  client.wanted.reset();
  client.job.reset();
  client.gate.Drop();
  if (renderer_.Frame(view.project) == nullptr) {
    // Once is enough: a browser may ask again whenever its camera rests.
    if (client.told_why_not.insert(view.project).second) Send(id, ErrorText(renderer_.WhyNot(view.project)));
    return;
  }
  const std::string error = ErrorOf([&] {
    client.job.emplace(view, renderer_);
    client.wanted = view.seq;
    UseCache(client);
  });
  if (!error.empty()) {
    client.job.reset();
    Send(id, ErrorText(error));
  }
}

void Scheduler::Ask(ClientId id, Client& client, const ClientMessage& message, uint32_t question_id, Level level) {
  std::erase_if(client.questions, [&](const Question& question) { return question.id == question_id; });
  if (client.questions.size() >= kMaxQuestions) {
    Send(id, ErrorText("too many questions at once; wait for the answers to the earlier ones", question_id));
    return;
  }
  const std::string error = ErrorOf([&] {
    Question question{.id = question_id, .level = level, .query = make_query_(message), .told = 0.0};
    SKYQUILT_CHECK(question.query != nullptr, "a question without an answer");
    client.questions.push_back(std::move(question));
  });
  if (!error.empty()) Send(id, ErrorText(error, question_id));
}

Scheduler::Level Scheduler::LevelOfView(const Client& client) const {
  // A frame that waits will be replaced by the next pass, so that pass can wait for those of others.
  if (client.gate.Full()) return kNotTaken;
  return client.job->pass() == 0 ? kFirstPass : kInTurn;
}

// Per level the one whose last turn is longest ago.
std::array<std::optional<Scheduler::Turn>, Scheduler::kLevels> Scheduler::Turns() const {
  std::array<std::optional<Turn>, kLevels> turns;
  const auto offer = [&](Level level, const Turn& turn) {
    if (!turns[level] || turn.served < turns[level]->served) turns[level] = turn;
  };
  const bool encoder_is_behind = encoder_.pending() >= kMaxEncodings;
  for (const auto& [id, client] : clients_) {
    std::array<bool, kLevels> asked{};
    for (size_t i = 0; i < client.questions.size(); ++i) {
      const Question& question = client.questions[i];
      // One at a time per client and level, in order: many questions are no more turns than one.
      if (std::exchange(asked[question.level], true)) continue;
      offer(question.level, {.client = id, .question = i, .served = client.question_served[question.level]});
    }
    if (!client.job) continue;
    const Level level = LevelOfView(client);
    if (level == kFirstPass || !encoder_is_behind) offer(level, {.client = id, .question = {}, .served = client.view_served});
  }
  return turns;
}

std::optional<Scheduler::Level> Scheduler::Choose(const std::array<std::optional<Turn>, kLevels>& turns) {
  std::optional<Level> chosen;
  for (size_t level = 0; level < kLevels; ++level) {
    if (!turns[level]) {
      passed_over_[level] = 0;
    } else if (!chosen || (passed_over_[level] >= kPatience && passed_over_[level] > passed_over_[*chosen])) {
      chosen = static_cast<Level>(level);
    }
  }
  if (!chosen) return {};
  for (size_t level = 0; level < kLevels; ++level) {
    if (turns[level]) ++passed_over_[level];
  }
  passed_over_[*chosen] = 0;
  return chosen;
}

bool Scheduler::Step() {
  const bool delivered = Deliver();
  const std::array<std::optional<Turn>, kLevels> turns = Turns();
  const std::optional<Level> level = Choose(turns);
  if (!level) return delivered;
  const Turn& turn = *turns[*level];
  Client& client = clients_.at(turn.client);
  ++turn_;
  if (turn.question) {
    StepQuestion(turn.client, client, *turn.question);
  } else {
    RenderView(turn.client, client);
  }
  Deliver();
  return true;
}

void Scheduler::RenderView(ClientId id, Client& client) {
  client.view_served = turn_;
  // Another client may have finished the same picture.
  UseCache(client);
  if (!client.job) return;
  const std::string error = ErrorOf([&] {
    const int number = client.job->pass();
    std::optional<RenderedPass> pass = client.job->Step(renderer_);
    if (!pass) return;
    pass->header.revision = state_.revision;
    Encoding encoding{.client = id, .seq = client.job->seq(), .pass = number, .key = client.job->Key(number), .scene = scene_};
    encoding_[encoder_.Add(std::move(*pass))] = std::move(encoding);
    if (client.job->Done()) client.job.reset();
  });
  if (error.empty()) return;
  client.job.reset();
  client.wanted.reset();
  Send(id, ErrorText(error));
}

// Sends the largest pass that is known already, and goes on after it.
void Scheduler::UseCache(Client& client) {
  FrameJob& job = *client.job;
  for (int pass = job.passes() - 1; pass >= job.pass(); --pass) {
    const FrameBytes frame = cache_.Find(job.Key(pass));
    if (frame == nullptr) continue;
    client.gate.Offer({job.seq(), pass, frame});
    job.SkipTo(pass + 1);
    break;
  }
  if (job.Done()) client.job.reset();
}

void Scheduler::StepQuestion(ClientId id, Client& client, size_t index) {
  Question& question = client.questions[index];
  client.question_served[question.level] = turn_;
  bool done = false;
  std::string reply;
  const std::string error = ErrorOf([&] {
    done = question.query->Step(renderer_.Access());
    if (done) reply = question.query->Reply();
  });
  if (!error.empty() || done) {
    Send(id, error.empty() ? std::move(reply) : ErrorText(error, question.id));
    client.questions.erase(client.questions.begin() + static_cast<std::ptrdiff_t>(index));
    return;
  }
  if (question.level != kInTurn) return;
  const double fraction = std::clamp(question.query->fraction(), 0.0, 1.0);
  if (fraction < question.told + kProgressStep) return;
  question.told = fraction;
  Send(id, ProgressText(question.id, fraction));
}

// Takes encoded passes and sends what clients may get. Returns whether anything was sent.
bool Scheduler::Deliver() {
  for (EncodedPass& encoded : encoder_.Take()) {
    const auto at = encoding_.find(encoded.ticket);
    if (at == encoding_.end()) continue;
    const Encoding encoding = std::move(at->second);
    encoding_.erase(at);
    if (encoding.scene != scene_) continue;
    const auto to = clients_.find(encoding.client);
    const bool wanted = to != clients_.end() && to->second.wanted == encoding.seq;
    if (encoded.bytes == nullptr) {
      base::LogError("view: a frame could not be encoded: {}", encoded.error);
      if (wanted) Send(encoding.client, ErrorText(kOurFault));
      continue;
    }
    cache_.Put(encoding.key, encoded.bytes);
    if (wanted) to->second.gate.Offer({encoding.seq, encoding.pass, std::move(encoded.bytes)});
  }
  bool sent = false;
  for (auto& [id, client] : clients_) {
    if (!client.gate.Waiting()) continue;
    const std::optional<Frame> frame = client.gate.Take(outbox_.queued(id));
    if (!frame) continue;
    outbox_.send(id, {.binary = true, .bytes = Readdressed(frame->bytes, frame->seq, state_.revision)});
    sent = true;
  }
  return sent;
}

}  // namespace skyquilt::viewer
