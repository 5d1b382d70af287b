// What a reader of the report must know before believing its figures, and what to do about it.
#pragma once

#include <vector>

#include "core/scene/train_report.h"
#include "core/survey/survey.h"
#include "evaluate/metrics.h"
#include "partition/block.h"

namespace skyquilt::evaluate {

// `training` is null when there is no record of it.
std::vector<Warning> CollectWarnings(const survey::Survey& survey, const partition::BlockSet& blocks, const scene::TrainReport* training,
                                     const Metrics& metrics);

}  // namespace skyquilt::evaluate
