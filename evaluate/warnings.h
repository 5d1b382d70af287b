// Warnings that a reader of the report must know to judge its numbers. Plain text, one sentence each.
#pragma once

#include <string>
#include <vector>

#include "core/scene/train_report.h"
#include "core/survey/survey.h"
#include "evaluate/metrics.h"
#include "partition/block.h"

namespace skyquilt::evaluate {

std::vector<std::string> CollectWarnings(const survey::Survey& survey, const partition::BlockSet& blocks, const scene::TrainReport* training,
                                         const Metrics& metrics);

}  // namespace skyquilt::evaluate
