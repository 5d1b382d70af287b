// How much training a time budget allows, before any was done: partition must know how many blocks it can train.
#pragma once

#include "coordinator/project/settings.h"

namespace skyquilt::coordinator {

// Optimiser steps that all blocks together get within the time budget, the context's share taken off; infinite without a budget. An estimate on the
// low side: nothing has measured this machine yet.
//   ranks        of the job; with more than one, the first trains no block
//   local_ranks  ranks on each machine, which share its threads
double ExpectedBlockSteps(const Settings& settings, int ranks, int local_ranks);

}  // namespace skyquilt::coordinator
