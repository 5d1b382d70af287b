// The other ranks during one piece of work that rank 0 leads: called together, told what they may use, and sent back to waiting.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/comm/communicator.h"

namespace skyquilt::coordinator {

struct GroupMember {
  int rank = 0;
  std::string host;
  int sharing = 1;            // ranks of the group on its machine, itself included
  int threads = 1;            // its share of the machine's
  double memory_bytes = 0.0;  // its share of what the machine's ranks may use together; 0 when it did not say
};

// Rank 0's side. Leaving it, by whatever way, sends everybody back to waiting.
class RankGroup {
 public:
  // Sends `setup` to every other rank under this tag.
  RankGroup(comm::Communicator& comm, int tag, const std::string& setup);
  ~RankGroup();
  RankGroup(const RankGroup&) = delete;
  RankGroup& operator=(const RankGroup&) = delete;

  // Waits until all are ready. Throws what one of them could not do, naming its rank and host: base::UsageError, base::InputError; base::Interrupted.
  std::vector<GroupMember> WaitForRanks();

 private:
  comm::Communicator& comm_;
};

// The side of any other rank. The body makes ready and calls Register with what it has ("threads", and "memory_bytes" where it counts); what it
// throws is told to rank 0. Returns when rank 0 sends everybody back.
void ServeRankGroup(comm::Communicator& comm, const std::function<void(nlohmann::json& hello)>& body);
// Only inside the body: reports for duty and returns rank 0's answer under this tag. Leaves the body when it sends everybody back instead.
std::string Register(comm::Communicator& comm, const nlohmann::json& hello, int tag);

}  // namespace skyquilt::coordinator
