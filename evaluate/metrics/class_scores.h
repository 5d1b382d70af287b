// Scores the surface by what it is: roofs, walls, ground, trees. Simulated surveys only. Where the survey's frame was fitted to GPS tags, the errors
// of normals include its tilt.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/packed_bytes.h"
#include "core/survey/surface_class.h"
#include "evaluate/metrics/metrics.h"
#include "evaluate/photos/photo_scorer.h"

namespace skyquilt::evaluate::metrics {

// Errors of depth and normals over several photos. Keeps eight bytes per scored pixel, and four more for each kind of field normals, as medians need
// all values.
class ClassErrors {
 public:
  // Adds the pixels of a photo that are scored and have a true depth and a true class. findings: result of ScorePhoto for this task; without true
  // classes nothing is added.
  void Add(const photos::HeldOutPhoto& task, const photos::PhotoResult& findings);
  // One entry for each of roof, wall, ground (roads included), road and tree, in this order; figures that no pixel measured are NaN. Empty if no
  // photo had true classes.
  std::vector<ClassScore> Result() const;
  // All that was added, so that other ClassErrors can go on from here.
  void Save(base::BytePacker* out) const;
  void Load(base::ByteUnpacker* in);

 private:
  struct Errors {
    std::vector<float> depth_m;     // along the ray, rendered minus true
    std::vector<float> normal_deg;  // 0 to 180; of the rendered depth
    std::vector<float> density_normal_deg, head_normal_deg;
    int64_t missing = 0;  // pixels without rendered depth
  };
  std::array<Errors, survey::kSurfaceClasses> errors_;
  bool any_ = false;
};

}  // namespace skyquilt::evaluate::metrics
