// What a reader of the report must know before believing its figures.
#pragma once

#include <string>
#include <vector>

#include "core/survey/survey.h"
#include "evaluate/metrics.h"
#include "evaluate/train_log.h"
#include "partition/block.h"

namespace skyquilt::evaluate {

std::vector<std::string> CollectWarnings(const survey::Survey& survey, const partition::BlockSet& blocks, const TrainLog& log,
                                         const Metrics& metrics);

}  // namespace skyquilt::evaluate
