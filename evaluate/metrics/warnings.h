// Warnings that a reader of the report must know to judge its numbers, and what to do about each.
#pragma once

#include <vector>

#include "core/scene/train_report.h"
#include "core/survey/survey.h"
#include "evaluate/metrics/metrics.h"
#include "partition/block.h"

namespace skyquilt::evaluate::metrics {

// Those about the place on Earth first. `training` is null when there is no record of it.
std::vector<Warning> CollectWarnings(const survey::Survey& survey, const partition::BlockSet& blocks, const scene::TrainReport* training,
                                     const Metrics& metrics);

}  // namespace skyquilt::evaluate::metrics
