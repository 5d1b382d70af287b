// Ranks that share the work of training the context: who takes part, and how what they do reaches the others.
#pragma once

#include <string>
#include <vector>

#include "coordinator/ranks/crew.h"
#include "coordinator/scheduler/field_job.h"
#include "core/comm/communicator.h"
#include "worker/trainer.h"

namespace skyquilt::coordinator {

// Rank 0 and others. wanted = 0: one rank of every other machine, at most seven; a number: so many in all, those of other machines first, for
// ranks of one machine share its cores. Empty when rank 0 would be alone.
std::vector<int> ChooseTeam(const std::vector<CrewMember>& crew, const std::string& own_host, int wanted);

// The team of a job as this rank sees it; of one member when the job has none.
// While others are waited for: throws base::Interrupted when rank 0 sends everybody back, and on rank 0 what a member could not do.
worker::Team MakeTeam(comm::Communicator& comm, const FieldJob& job);

}  // namespace skyquilt::coordinator
