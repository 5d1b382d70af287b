// Starts and ends one training or rendering on the other ranks. Each of them loads its data, reports its threads and memory, and receives the part of
// the machine that it may use; at the end it returns to waiting for the next one.
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
  int ranks_on_host = 1;      // number of ranks on its machine, itself included
  int threads = 1;            // the machine's threads divided by `ranks_on_host`, at least 1
  double memory_bytes = 0.0;  // the machine's memory limit divided by `ranks_on_host`; 0 when the rank did not report one
};

// Rank 0's side. The destructor sends kTagDone, so the other ranks return to waiting also after an exception.
class RankGroup {
 public:
  // Sends `setup` to every other rank with this tag.
  RankGroup(comm::Communicator& comm, int tag, const std::string& setup);
  ~RankGroup();
  RankGroup(const RankGroup&) = delete;
  RankGroup& operator=(const RankGroup&) = delete;

  // Waits until all ranks are ready. When one of them fails, throws base::UsageError or base::InputError naming its rank and host.
  // Throws base::Interrupted after a signal.
  std::vector<GroupMember> WaitForRanks();

 private:
  comm::Communicator& comm_;
};

// The other ranks' side. The body loads its data, adds "threads" (and "memory_bytes" for rendering) to `hello`, calls Register and then works.
// An exception of the body is reported to rank 0 and not thrown. Returns after kTagDone.
void ServeRankGroup(comm::Communicator& comm, const std::function<void(nlohmann::json& hello)>& body);
// Only inside the body: reports that this rank is ready and returns rank 0's answer with this tag. When kTagDone comes instead, it leaves the
// body by an exception that ServeRankGroup catches.
std::string Register(comm::Communicator& comm, const nlohmann::json& hello, int tag);

}  // namespace skyquilt::coordinator
