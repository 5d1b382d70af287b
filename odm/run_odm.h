// 'skyquilt odm': from a dataset in OpenDroneMap's layout to its products in OpenDroneMap's folders.
#pragma once

#include <string>
#include <vector>

#include "coordinator/stages/pipeline.h"
#include "odm/dataset.h"
#include "odm/request.h"

namespace skyquilt::odm {

// Runs the stages that the request asks for, in pipeline.project, which must be dataset.project, and puts the results in place. Stages whose options
// have changed since an earlier run begin anew. pipeline.settings: from ApplyRequest; `threads` etc. are theirs. Throws what the stages throw;
// base::BlockError only at the end, when everything else is in place.
void RunOdm(coordinator::Pipeline& pipeline, const Request& request, const Dataset& dataset);

// What is said before the work begins: options without effect, and what is needless.
std::vector<std::string> OpeningLines(const Request& request, const Dataset& dataset);

// The exit status for NodeODM, which shows 3 as a fault of the installation, 137 as too little memory and 1 as "cannot process dataset": bad input
// (3) and blocks that failed (4) become 1. Others stay.
int StatusForCaller(int status);

}  // namespace skyquilt::odm
