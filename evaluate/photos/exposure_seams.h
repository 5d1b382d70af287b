// Measures whether exposure differences between photos are baked into the scene's colours. If they are, the brightness on the map changes at the
// border of a photo's footprint. So the ground just inside the border is compared with the ground just outside, seen from above at normal brightness.
#pragma once

#include "core/base/thread_pool.h"
#include "core/scene/scene.h"
#include "evaluate/measured.h"
#include "evaluate/photos/coverage.h"

namespace skyquilt::evaluate::photos {

struct ExposureSeams {
  // Medians over photos of |mean outside - mean inside| in display values (1 = white), colours averaged; NaN without photos.
  double border = kNotMeasured;
  double control = kNotMeasured;  // the same at lines further inside the footprint, where there is no border: the effect of texture alone
  int photos = 0;                 // measured
};

// Largest number of views to measure, evenly spread.
constexpr int kMaxSeamPhotos = 96;
ExposureSeams MeasureExposureSeams(const scene::Scene& scene, const std::vector<TrainingView>& views, base::ThreadPool& threads);

}  // namespace skyquilt::evaluate::photos
