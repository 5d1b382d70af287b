#include "coordinator/rendering/rank_parts.h"

#include <algorithm>
#include <atomic>
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
  bool opening = true, ready = false;
  uint64_t request = 0;
  std::vector<size_t> parts;  // that it makes now
};

// Of a job or a request, never used twice: answers to an earlier one may be late.
uint64_t NewNumber() {
  static std::atomic<uint64_t> last = 0;
  return ++last;
}

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
  // Answers to an earlier job, which ended before all ranks had opened it, may come late.
  const uint64_t number = NewNumber();
  json setup = job.setup;
  setup["kind"] = job.kind;
  setup["number"] = number;
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
  while (made < n_parts) {
    bool anyone = false;
    for (auto& [rank, maker] : makers) {
      if (maker.ready && maker.parts.empty() && !waiting.empty()) {
        const size_t n = std::min(waiting.size(), std::max<size_t>(1, job.at_once(maker.threads)));
        maker.parts.assign(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(n));
        waiting.erase(waiting.begin(), waiting.begin() + static_cast<std::ptrdiff_t>(n));
        base::BytePacker request;
        request.Add(maker.request = NewNumber());
        job.ask(maker.parts, request);
        comm_.Send(rank, kTagParts, request.Take());
      }
      anyone = anyone || maker.ready || maker.opening;
    }
    if (!anyone) break;  // the caller makes the rest
    const comm::Message message = comm_.Receive();
    const auto at = makers.find(message.source);
    if (at == makers.end()) continue;
    Maker& maker = at->second;
    // A rank says this a second time when it cannot open the scene after all; it renders nothing then either.
    if (message.tag == kTagReady) {
      const json hello = base::ParseJson(message.bytes);
      if (hello.contains("failure")) Throw(FailureFromJson(hello.at("failure")), comm_.NameOf(message.source));
    }
    if (message.tag == kTagJobReady) {
      base::ByteUnpacker answer(message.bytes, kUnreadable);
      if (answer.Take<uint64_t>() != number) continue;
      const auto failure = answer.Take<std::string>();
      maker.opening = false;
      maker.ready = failure.empty();
      if (!maker.ready) drop(message.source, FailureFromJson(base::ParseJson(failure)));
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

std::string OpenJob(const std::string& setup_text, double memory_bytes, base::ThreadPool& threads, std::unique_ptr<PartMaker>* maker) {
  const json setup = base::ParseJson(setup_text);
  std::string failure;
  try {
    *maker = OpenPartMaker(setup, memory_bytes, threads);
  } catch (...) {
    failure = base::JsonText(ToJson(CurrentFailure()));
  }
  base::BytePacker answer;
  answer.Add(setup.at("number").get<uint64_t>());
  answer.Add(failure);
  return answer.Take();
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
