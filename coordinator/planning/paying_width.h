// Chooses the width to which photos are scaled down for training, where run.image_width is "auto": as wide as the training can use. A wider photo
// has more pixels to learn, more blocks and finer maps; with too few samples for its pixels it ends less sharp than a smaller one. Measured in
// docs/experiments/capacity-and-encodings.md. Pure: no clock, no files.
#pragma once

#include <functional>
#include <vector>

#include "coordinator/planning/needs.h"
#include "coordinator/planning/plan.h"
#include "coordinator/planning/predictor.h"
#include "coordinator/planning/work_size.h"
#include "coordinator/project/settings.h"

namespace skyquilt::coordinator {

// Widths in pixels, the widest first: from the photos' own down to kLeastAutoWidth, each 0.8 of the one before. Photos that are no wider: that alone.
std::vector<int> WidthsToChooseFrom(int photo_width);

// The first of these that `samples` of training, all blocks together and without the context, are enough for, whose decoded photos fit into half of
// the memory, and for whose project there is room on the disk; the last where none is. samples: infinite or not positive where no time was given: the
// last.
int PayingWidth(const WorkSize& size, Settings settings, double samples, const Room& room);

// For a total time. plan_at: the plan with these settings. Where the settings' width is kAutoWidth, plans with the widest photos that their training
// time pays for, whose other stages leave most of the time to training, and for which nothing is given up that would be made with kLeastAutoWidth.
Plan PlanWithPayingWidth(const Predictor& predictor, Settings settings, const Room& room, const std::function<Plan(const Settings&)>& plan_at);

}  // namespace skyquilt::coordinator
