// Do the photos' footprints show on the map? Seen from above at normal brightness, the ground just inside the border of a photo's footprint is
// compared with the ground just outside. Where exposure differences were taken into the scene's colours, a step stands there.
#pragma once

#include "core/base/thread_pool.h"
#include "core/scene/scene.h"
#include "evaluate/coverage.h"
#include "evaluate/metrics.h"

namespace skyquilt::evaluate {

struct ExposureSeams {
  // Medians over photos of |mean outside - mean inside| in display values (1 = white), colours averaged; NaN without photos.
  double border = kNotMeasured;
  double control = kNotMeasured;  // the same across lines a little further inside, where no border runs: what texture alone gives
  int photos = 0;
};

// At most kFootprints of the views, evenly spread.
constexpr int kFootprints = 96;
ExposureSeams MeasureExposureSeams(const scene::Scene& scene, const std::vector<TrainingView>& views, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate
