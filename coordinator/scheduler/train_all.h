// Trains the context and then every block of a survey, over all ranks.
// Rank 0 trains the context with all its cores. Then it hands out the blocks, most expensive first; it trains blocks only when it is the only rank.
// All ranks read survey, blocks and pixels from the same project folder.
#pragma once

#include <string>
#include <vector>

#include "coordinator/project/project.h"
#include "coordinator/project/settings.h"
#include "coordinator/scheduler/field_job.h"
#include "core/comm/communicator.h"
#include "core/scene/train_report.h"
#include "core/survey/survey.h"
#include "partition/block.h"

namespace skyquilt::coordinator {

struct TrainInput {
  const survey::Survey* survey = nullptr;
  const partition::BlockSet* blocks = nullptr;
  std::string config_hash;  // hash of everything the result depends on; checkpoints with another hash are refused
  // Blocks of an earlier training that stay as they are (kept_blocks.h).
  std::vector<FieldOutcome> kept = {};
  bool verbose = false;
  bool quiet = false;
};

// Call it on rank 0. Writes checkpoints, <field>.log.csv and train.json into the project, and continues from existing checkpoints. Returns the
// results of every field; blocks that failed after all tries have ok = false. Throws base::Interrupted (everything is saved), base::InputError,
// base::UsageError, and base::BlockError when the context failed.
scene::TrainReport TrainAll(comm::Communicator& comm, const TrainInput& input, const Settings& settings, const Project& project);

// The other ranks' side: trains blocks for rank 0 until kTagDone. setup: content of the kTagSetup message.
// Errors of a training are reported to rank 0 and not thrown.
void ServeTraining(comm::Communicator& comm, const std::string& setup);

}  // namespace skyquilt::coordinator
