#include "coordinator/rendering/rank_parts.h"

#include <algorithm>
#include <deque>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "coordinator/ranks/failure.h"
#include "coordinator/ranks/rank_messages.h"
#include "core/base/errors.h"
#include "core/base/json_text.h"
#include "core/base/log.h"

namespace skyquilt::coordinator {
namespace {

using nlohmann::json;

constexpr const char* kUnreadable = "a message about parts of a job cannot be read";

// What rank 0 knows of a rank while it makes parts.
struct Maker {
  int threads = 1;
  bool ready = false;
  uint64_t request = 0;
  std::vector<size_t> parts;  // that it makes now
};

// Tells all ranks that the job is over, after an exception too.
class JobOnRanks {
 public:
  JobOnRanks(comm::Communicator& comm, std::map<int, Maker>& makers, const std::string& setup) : comm_(comm), makers_(makers) {
    for (const auto& [rank, maker] : makers_) comm_.Send(rank, kTagJobOpen, setup);
  }
  ~JobOnRanks() {
    for (const auto& [rank, maker] : makers_) comm_.Send(rank, kTagJobEnd, "");
  }
  JobOnRanks(const JobOnRanks&) = delete;
  JobOnRanks& operator=(const JobOnRanks&) = delete;

 private:
  comm::Communicator& comm_;
  std::map<int, Maker>& makers_;
};

}  // namespace

void RankParts::Make(const Job& job, size_t n_parts) {
  std::map<int, Maker> makers;  // by rank
  for (const GroupMember& member : members_) makers[member.rank].threads = member.threads;
  json setup = job.setup;
  setup["kind"] = job.kind;
  const JobOnRanks ranks(comm_, makers, base::JsonText(setup));
  std::deque<size_t> waiting(n_parts);
  std::iota(waiting.begin(), waiting.end(), size_t{0});
  size_t made = 0;
  std::set<int> made_by;
  const auto drop = [&](int rank, const Failure& failure) {
    if (failure.kind == Failure::kInterrupted) Throw(failure);
    base::LogWarning("{} does not work on {}, others do: {}", comm_.NameOf(rank), job.what, failure.Text());
    Maker& maker = makers.at(rank);
    waiting.insert(waiting.begin(), maker.parts.begin(), maker.parts.end());
    maker.parts.clear();
    maker.ready = false;
  };
  size_t starting = makers.size();
  while (made < n_parts) {
    bool anyone = starting > 0;
    for (auto& [rank, maker] : makers) {
      if (maker.ready && maker.parts.empty() && !waiting.empty()) {
        const size_t n = std::min(waiting.size(), std::max<size_t>(1, job.at_once(maker.threads)));
        maker.parts.assign(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(n));
        waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(n));
        base::BytePacker request;
        request.Add(maker.request = next_request_++);
        job.ask(maker.parts, request);
        comm_.Send(rank, kTagParts, request.Take());
      }
      anyone = anyone || maker.ready;
    }
    if (!anyone) break;  // the caller makes the rest
    const comm::Message message = comm_.Receive();
    const auto at = makers.find(message.source);
    if (at == makers.end()) continue;
    Maker& maker = at->second;
    if (message.tag == kTagJobReady) {
      --starting;
      maker.ready = message.bytes.empty();
      if (!maker.ready) drop(message.source, FailureFromJson(base::ParseJson(message.bytes)));
    }
    if (message.tag != kTagPartsMade) continue;
    base::ByteUnpacker reply(message.bytes, kUnreadable);
    if (reply.Take<uint64_t>() != maker.request || maker.parts.empty()) continue;
    if (const auto failure = reply.Take<std::string>(); !failure.empty()) {
      drop(message.source, FailureFromJson(base::ParseJson(failure)));
      continue;
    }
    const std::vector<size_t> parts = std::exchange(maker.parts, {});
    job.take(parts, reply);
    reply.End();
    made += parts.size();
    made_by.insert(message.source);
  }
  if (made > 0)
    base::LogInfo("{} {} of {} {} by {} other rank{}", made, job.parts, job.what, job.done, made_by.size(), made_by.size() == 1 ? "" : "s");
}

std::string AnswerParts(PartMaker& maker, const std::string& request) {
  base::ByteUnpacker unpacker(request, kUnreadable);
  const auto number = unpacker.Take<uint64_t>();
  base::BytePacker reply;
  reply.Add(number);
  reply.Add(std::string());  // no failure
  try {
    maker.Make(unpacker, reply);
  } catch (...) {
    base::BytePacker failure;
    failure.Add(number);
    failure.Add(base::JsonText(ToJson(CurrentFailure())));
    return failure.Take();
  }
  return reply.Take();
}

}  // namespace skyquilt::coordinator
