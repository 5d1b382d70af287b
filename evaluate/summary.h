// From the scores of the photos to the metrics of the scene.
#pragma once

#include <vector>

#include "core/metrics/depth_errors.h"
#include "core/metrics/psnr.h"
#include "evaluate/evaluate_input.h"
#include "evaluate/exposure_seams.h"
#include "evaluate/floater_opacity.h"
#include "evaluate/held_out_scorer.h"
#include "evaluate/metrics.h"
#include "evaluate/seam_errors.h"

namespace skyquilt::evaluate {

// Of all photos together: each one's score, and the sums that means over photos cannot give.
struct Scores {
  std::vector<PhotoScore> photos;
  std::vector<metrics::SquaredError> per_block;
  SeamErrors seams;
  metrics::DepthErrorCollector depth;
  FloaterOpacity air;
  ExposureSeams footprints;

  // n_boxes: of the scene's area.
  explicit Scores(size_t n_boxes) : per_block(n_boxes) {}
  void Add(const ScoredPhoto& photo);
  double Psnr() const;      // dB, mean over the photos; NaN when none has one
  double Coverage() const;  // covered share of all used pixels; NaN when none is used
};

// What is known before any photo is scored: survey, training, machine.
Metrics KnownFacts(const EvaluateInput& input);
// Adds what the scores say, what scoring took so far, and the warnings.
void Summarise(const EvaluateInput& input, const Scores& scores, Metrics* metrics);

}  // namespace skyquilt::evaluate
