#include "coordinator/rendering/remote_renderer.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "coordinator/ranks/rank_messages.h"
#include "core/base/errors.h"
#include "core/base/json_text.h"

namespace skyquilt::coordinator {
namespace {

using scene::kFinished;
using scene::RayInFlight;

// Requests that a rank has at a time: one that it renders and the next one.
constexpr size_t kWithRank = 2;

}  // namespace

// One call of Render.
struct RemoteRenderer::Work {
  std::span<const render::Ray> rays;
  std::span<render::RayColor> out;
  render::EngineOptions options;
  std::vector<RayInFlight> in_flight;
  size_t chunk = 1;                                      // rays per request
  size_t next_ray = 0;                                   // first ray that no group has yet
  size_t arrived = 0;                                    // finished rays
  std::map<int, std::deque<Request>> waiting;            // per rank: not sent yet
  std::map<int, std::map<uint64_t, Request>> with_rank;  // per rank: sent and not answered, by request id
  std::vector<size_t> in_group;                          // per group: rays that are not finished
};

RemoteRenderer::RemoteRenderer(comm::Communicator& comm, const std::string& setup) : comm_(comm), group_(comm, kTagScene, setup) {
  SKYQUILT_CHECK(comm.size() > 1, "rendering by other ranks");
}

void RemoteRenderer::Begin(const scene::FieldStore& store, const render::RaySegments& segments) {
  store_ = &store;
  segments_ = &segments;
  splitter_.emplace(segments);
  members_ = group_.WaitForRanks();
  std::vector<int> ranks;
  std::vector<double> memory;
  for (const GroupMember& member : members_) {
    ranks.push_back(member.rank);
    memory.push_back(member.memory_bytes);
  }
  groups_ = MakeRenderGroups(store, ranks, memory);
  for (const RenderGroup& group : groups_) {
    for (size_t number = 0; number < group.ranks.size(); ++number) {
      const auto member = std::find_if(members_.begin(), members_.end(), [&](const GroupMember& one) { return one.rank == group.ranks[number]; });
      const nlohmann::json part = {{"threads", member->threads}, {"memory_bytes", member->memory_bytes}, {"number", number}, {"owner", group.owner}};
      comm_.Send(member->rank, kTagAssignment, base::JsonText(part));
    }
  }
  statistics_.ranks = static_cast<int>(ranks.size());
  statistics_.groups = static_cast<int>(groups_.size());
}

void RemoteRenderer::Render(std::span<const render::Ray> rays, std::span<render::RayColor> out, const render::EngineOptions& options) {
  SKYQUILT_CHECK(store_ != nullptr, "Begin comes first");
  if (broken_) Throw(*broken_);
  Work work;
  work.rays = rays;
  work.out = out;
  work.options = options;
  work.in_flight.resize(rays.size());
  work.chunk = RaysPerRequest(rays.size(), statistics_.ranks);
  work.in_group.assign(groups_.size(), 0);
  statistics_.rays += static_cast<int64_t>(rays.size());
  while (work.arrived < rays.size()) {
    HandOut(work);
    const comm::Message message = comm_.Receive();
    if (message.tag == kTagRayReply) TakeBack(work, message);
    // A rank says this a second time when it cannot open the scene after all.
    if (message.tag == kTagReady) {
      const nlohmann::json hello = base::ParseJson(message.bytes);
      if (!hello.contains("failure")) continue;
      broken_ = FailureFromJson(hello.at("failure"));
      Throw(*broken_, "rank " + std::to_string(message.source));
    }
  }
}

// Gives new rays to the group with the fewest unfinished rays per rank, and sends waiting requests to their ranks.
void RemoteRenderer::HandOut(Work& work) {
  while (work.next_ray < work.rays.size()) {
    const auto load = [&](size_t group) { return static_cast<double>(work.in_group[group]) / static_cast<double>(groups_[group].ranks.size()); };
    size_t least = 0;
    for (size_t group = 1; group < groups_.size(); ++group) {
      if (load(group) < load(least)) least = group;
    }
    // Each rank has enough: one chunk that it renders and the next one.
    if (load(least) >= static_cast<double>(kWithRank * work.chunk)) break;
    AddChunk(work, least);
  }
  for (auto& [rank, requests] : work.waiting) {
    while (!requests.empty() && work.with_rank[rank].size() < kWithRank) Send(work, rank);
  }
}

void RemoteRenderer::AddChunk(Work& work, size_t group) {
  const RenderGroup& members = groups_[group];
  std::map<int, Request> requests;  // per rank
  std::vector<render::RaySegment> segments;
  const size_t end = std::min(work.rays.size(), work.next_ray + work.chunk);
  const auto anyone = static_cast<int>((work.next_ray / work.chunk) % members.ranks.size());
  for (size_t i = work.next_ray; i < end; ++i) {
    int owner = anyone;
    if (members.ranks.size() > 1) {
      segments.clear();
      splitter_->Split(work.rays[i], &segments);
      // Every rank has the context. The owner of the first block on the ray starts it, so that the ray is passed on less often.
      const auto first = std::find_if(segments.begin(), segments.end(), [&](const auto& segment) { return !segments_->Blocks(segment.set).empty(); });
      if (first != segments.end()) owner = OwnerOf(members.owner, segments_->Blocks(first->set), anyone);
    }
    requests[members.ranks[static_cast<size_t>(owner)]].rays.push_back(i);
  }
  work.in_group[group] += end - work.next_ray;
  work.next_ray = end;
  for (auto& [rank, request] : requests) {
    request.group = group;
    Queue(work, rank, std::move(request));
  }
}

// Small requests of one group become one.
void RemoteRenderer::Queue(Work& work, int rank, Request request) {
  std::deque<Request>& waiting = work.waiting[rank];
  if (!waiting.empty() && waiting.back().rays.size() + request.rays.size() <= work.chunk) {
    waiting.back().rays.insert(waiting.back().rays.end(), request.rays.begin(), request.rays.end());
  } else {
    waiting.push_back(std::move(request));
  }
}

void RemoteRenderer::Send(Work& work, int rank) {
  Request request = std::move(work.waiting[rank].front());
  work.waiting[rank].pop_front();
  RayRequest message{.id = next_id_++, .options = work.options, .rays = {}, .in_flight = {}};
  for (const size_t i : request.rays) {
    message.rays.push_back(work.rays[i]);
    message.in_flight.push_back(work.in_flight[i]);
  }
  const std::string bytes = ToBytes(message);
  statistics_.bytes_sent += static_cast<int64_t>(bytes.size());
  comm_.Send(rank, kTagRays, bytes);
  work.with_rank[rank].emplace(message.id, std::move(request));
}

void RemoteRenderer::TakeBack(Work& work, const comm::Message& message) {
  const int rank = message.source;
  const RayReply reply = RayReplyFromBytes(message.bytes);
  std::map<uint64_t, Request>& with_rank = work.with_rank[rank];
  const auto at = with_rank.find(reply.id);
  if (at == with_rank.end()) return;  // from an earlier call of Render that ended with an exception
  if (reply.failure) Throw(reply.failure, "rank " + std::to_string(rank));
  const Request request = std::move(at->second);
  with_rank.erase(at);
  SKYQUILT_CHECK(reply.in_flight.size() == request.rays.size(), "a request comes back whole");
  statistics_.bytes_received += static_cast<int64_t>(message.bytes.size());
  statistics_.samples += reply.samples;
  statistics_.field_loads += reply.field_loads - std::exchange(loads_[rank], reply.field_loads);
  const RenderGroup& group = groups_[request.group];
  std::map<int, Request> onward;  // per rank
  size_t color = 0;
  for (size_t k = 0; k < request.rays.size(); ++k) {
    const size_t i = request.rays[k];
    if (reply.in_flight[k].owner == kFinished) {
      work.out[i] = reply.colors.at(color++);
      ++work.arrived;
      --work.in_group[request.group];
      continue;
    }
    work.in_flight[i] = reply.in_flight[k];
    const int next = group.ranks.at(static_cast<size_t>(reply.in_flight[k].owner));
    SKYQUILT_CHECK(next != rank, "a rank returned a ray that it owns itself");
    onward[next].rays.push_back(i);
    ++statistics_.handovers;
  }
  for (auto& [next, more] : onward) {
    more.group = request.group;
    Queue(work, next, std::move(more));
  }
}

}  // namespace skyquilt::coordinator
