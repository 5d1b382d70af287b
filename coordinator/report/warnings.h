// What a reader of the report must know before believing its figures.
#pragma once

#include <string>
#include <vector>

#include "coordinator/report/metrics.h"
#include "coordinator/report/train_log.h"
#include "core/survey/survey.h"
#include "partition/block.h"

namespace skyquilt::report {

std::vector<std::string> CollectWarnings(const survey::Survey& survey, const partition::BlockSet& blocks, const TrainLog& log,
                                         const Metrics& metrics);

}  // namespace skyquilt::report
