// Trains the context and then every block of a survey, over all ranks.
// Rank 0 trains the context with all its cores, then hands out blocks, most expensive first, and trains them itself only when it is alone.
// All ranks read survey, blocks and pixels from the project folder, which they share.
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
  std::string config_hash;  // of everything the result depends on; checkpoints with another one are refused
  bool verbose = false;
  bool quiet = false;
};

// Called on rank 0. Returns and writes the training results of every field; blocks that failed after all tries are not ok. Writes checkpoints,
// <field>.log.csv and train.json into the project; continues from what is there. Throws base::Interrupted (everything saved), base::InputError,
// base::UsageError, base::BlockError when the context itself failed.
scene::TrainReport TrainAll(comm::Communicator& comm, const TrainInput& input, const Settings& settings, const Project& project);

// One training as every other rank sees it, begun by kTagSetup with this text: trains blocks for rank 0 until kTagDone.
// Never throws for what a training met.
void ServeTraining(comm::Communicator& comm, const std::string& setup);

}  // namespace skyquilt::coordinator
