// How fast the samplers of bins (worker/samplers/bin_sampler.h) place the samples of rays, and their proposals learn.
#pragma once

#include <string>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/render/trained_field.h"

namespace skyquilt::bench {

struct SamplerSpeed {
  std::string sampler;
  std::vector<int> samples;            // per pass
  int field_samples = 0;               // of the field's pass, with those that it has from an earlier one
  double place_rays_per_second = 0.0;  // all passes but the field's last
  double learn_rays_per_second = 0.0;  // of the proposals; 0: it has none
};

// Of random rays through the field's box, with the sampler's own numbers of samples; a few times `seconds` in all. Medians of `rounds`.
std::vector<SamplerSpeed> MeasureSamplers(const render::TrainedField& target, double seconds, int rounds, base::ThreadPool& threads);

}  // namespace skyquilt::bench
