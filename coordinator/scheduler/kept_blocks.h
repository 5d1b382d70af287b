// Which blocks keep their training when photos were added to a project: those for which nothing has changed that their training depends on. Options
// are the same, or the stage refuses them; what remains are the block's box, sizes and photos, with poses and lenses. The context, which is of the
// whole survey, is always trained again, and is not among it: kept blocks were guided by the one before.
#pragma once

#include <string>
#include <vector>

#include "coordinator/project/project.h"
#include "coordinator/scheduler/field_job.h"
#include "core/survey/survey.h"
#include "partition/block.h"

namespace skyquilt::coordinator {

// Identity of what the training of a block depends on besides options and context.
std::string TrainingIdentity(const survey::Survey& survey, const partition::Block& block);

// The earlier results (Project::Earlier) of the blocks that stay, with their present ids: trained to the end, and with the same checkpoint as then.
// None in a project to which nothing was added. `say`: in the log, and why others are trained.
std::vector<FieldOutcome> KeptBlocks(const Project& project, const survey::Survey& survey, const partition::BlockSet& blocks, bool say);

}  // namespace skyquilt::coordinator
