#include "coordinator/scheduler/training_team.h"

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "coordinator/ranks/messages.h"
#include "coordinator/scheduler/coordinate.h"
#include "core/base/errors.h"

namespace skyquilt::coordinator {
namespace {

constexpr int kMostMachines = 8;

// Everybody sends to everybody, in steps: a member that is a step ahead waits for the others there.
class Exchange {
 public:
  Exchange(comm::Communicator& comm, const FieldJob& job, size_t number) : comm_(comm), ranks_(job.team), number_(number), attempt_(job.attempt) {}

  std::vector<std::string> operator()(std::string own) {
    for (size_t other = 0; other < ranks_.size(); ++other) {
      if (other != number_) comm_.Send(ranks_[other], kTagShare, own);
    }
    std::vector<std::string> all(ranks_.size());
    all[number_] = std::move(own);
    for (size_t other = 0; other < ranks_.size(); ++other) {
      if (other != number_) all[other] = Await(ranks_[other]);
    }
    // Nothing moves while this rank computes the next step.
    comm_.Flush();
    return all;
  }

 private:
  std::string Await(int source) {
    while (true) {
      const auto at = std::find_if(early_.begin(), early_.end(), [source](const comm::Message& message) { return message.source == source; });
      if (at != early_.end()) {
        std::string bytes = std::move(at->bytes);
        early_.erase(at);
        return bytes;
      }
      comm::Message message = WaitForMessage(comm_);
      if (message.tag == kTagShare) {
        early_.push_back(std::move(message));
        continue;
      }
      if (message.tag == kTagDone || message.tag == kTagStop) throw base::Interrupted();
      // A member that leaves before the others has met something.
      if (message.tag == kTagOutcome) {
        const FieldOutcome outcome = OutcomeFromText(message.bytes);
        if (outcome.job.attempt != attempt_) continue;
        ThrowIfEndsCommand(outcome);
        throw base::InputError(outcome.job.name, "rank " + std::to_string(message.source) + ": " + outcome.reason,
                               "Train with --set run.context_ranks=1");
      }
    }
  }

  comm::Communicator& comm_;
  std::vector<int> ranks_;
  size_t number_;
  int attempt_;
  std::vector<comm::Message> early_;
};

}  // namespace

std::vector<int> ChooseTeam(const std::vector<CrewMember>& crew, const std::string& own_host, int wanted) {
  std::vector<int> team = {0};
  std::map<std::string, int> chosen_on = {{own_host, 1}};
  std::set<int> chosen;
  const auto most = static_cast<size_t>(wanted > 0 ? wanted : kMostMachines);
  while (team.size() < most && chosen.size() < crew.size()) {
    const CrewMember* next = nullptr;
    for (const CrewMember& member : crew) {
      if (!chosen.contains(member.rank) && (next == nullptr || chosen_on[member.host] < chosen_on[next->host])) next = &member;
    }
    if (wanted == 0 && chosen_on[next->host] > 0) break;
    team.push_back(next->rank);
    chosen.insert(next->rank);
    ++chosen_on[next->host];
  }
  return team.size() > 1 ? team : std::vector<int>();
}

worker::Team MakeTeam(comm::Communicator& comm, const FieldJob& job) {
  worker::Team team;
  if (job.team.size() < 2) return team;
  team.members = static_cast<int>(job.team.size());
  const auto own = std::find(job.team.begin(), job.team.end(), comm.rank());
  SKYQUILT_CHECK(own != job.team.end(), "a member of the team");
  team.number = static_cast<int>(own - job.team.begin());
  team.exchange = Exchange(comm, job, static_cast<size_t>(team.number));
  team.summon = [&comm, job] {
    for (size_t number = 1; number < job.team.size(); ++number) comm.Send(job.team[number], kTagJob, ToText(job));
  };
  return team;
}

}  // namespace skyquilt::coordinator
