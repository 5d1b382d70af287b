#include "coordinator/ranks/rank_group.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "coordinator/ranks/failure.h"
#include "coordinator/ranks/rank_messages.h"
#include "core/base/json_text.h"
#include "core/base/system.h"

namespace skyquilt::coordinator {
namespace {

using nlohmann::json;

// Thrown by Register when rank 0 ends the work before it started, for instance because another rank failed.
struct SentBack {};

}  // namespace

RankGroup::RankGroup(comm::Communicator& comm, int tag, const std::string& setup) : comm_(comm) {
  for (int rank = 1; rank < comm.size(); ++rank) comm.Send(rank, tag, setup);
}

RankGroup::~RankGroup() {
  for (int rank = 1; rank < comm_.size(); ++rank) comm_.Send(rank, kTagDone, "");
}

std::vector<GroupMember> RankGroup::WaitForRanks() {
  std::vector<json> hello(static_cast<size_t>(comm_.size()));
  std::map<std::string, int> ranks_on;
  for (int n = 1; n < comm_.size();) {
    const comm::Message message = comm_.Receive();
    if (message.tag != kTagReady) continue;
    json one = base::ParseJson(message.bytes);
    const std::string host = one.at("host").get<std::string>();
    if (one.contains("failure")) Throw(FailureFromJson(one.at("failure")), comm_.NameOf(message.source));
    ++ranks_on[host];
    hello[static_cast<size_t>(message.source)] = std::move(one);
    ++n;
  }
  std::vector<GroupMember> members;
  for (int rank = 1; rank < comm_.size(); ++rank) {
    const json& one = hello[static_cast<size_t>(rank)];
    GroupMember member{.rank = rank, .host = one.at("host").get<std::string>()};
    member.ranks_on_host = ranks_on[member.host];
    member.threads = std::max(1, one.at("threads").get<int>() / member.ranks_on_host);
    member.memory_bytes = one.value("memory_bytes", 0.0) / member.ranks_on_host;
    members.push_back(member);
  }
  return members;
}

std::string Register(comm::Communicator& comm, const json& hello, int tag) {
  comm.Send(0, kTagReady, base::JsonText(hello));
  while (true) {
    comm::Message message = WaitForMessage(comm);
    if (message.tag == tag) return std::move(message.bytes);
    if (message.tag == kTagDone) throw SentBack();
  }
}

void ServeRankGroup(comm::Communicator& comm, const std::function<void(json& hello)>& body) {
  json hello = {{"host", base::HostName()}};
  try {
    body(hello);
    return;
  } catch (const SentBack&) {
    return;
  } catch (...) {
    const Failure failure = CurrentFailure();
    if (failure.kind == Failure::kInterrupted) return;  // rank 0 is gone
    hello["failure"] = ToJson(failure);
  }
  comm.Send(0, kTagReady, base::JsonText(hello));
  while (WaitForMessage(comm).tag != kTagDone) {
  }
}

}  // namespace skyquilt::coordinator
