// Computes the metrics of the scene from the scores of the photos.
#pragma once

#include <vector>

#include "core/base/packed_bytes.h"
#include "core/metrics/depth_errors.h"
#include "core/metrics/psnr.h"
#include "evaluate/evaluate_input.h"
#include "evaluate/metrics/class_scores.h"
#include "evaluate/metrics/metrics.h"
#include "evaluate/photos/exposure_seams.h"
#include "evaluate/photos/flat_roofs.h"
#include "evaluate/photos/floater_opacity.h"
#include "evaluate/photos/held_out_scorer.h"
#include "evaluate/photos/seam_errors.h"
#include "evaluate/trust/sparsification.h"

namespace skyquilt::evaluate::metrics {

// Scores of all photos, and sums over their pixels for pooled values.
struct Scores {
  std::vector<photos::PhotoScore> photos;
  std::vector<skyquilt::metrics::SquaredError> per_block;
  photos::SeamErrors seams;
  skyquilt::metrics::DepthErrorCollector depth;
  ClassErrors classes;
  photos::FlatRoofPoints flat_roofs;
  photos::FloaterOpacity floaters;
  trust::TrustPixels trust;
  photos::ExposureSeams exposure_seams;

  // n_boxes: HeldOutScorer::n_boxes().
  explicit Scores(size_t n_boxes) : per_block(n_boxes) {}
  void Add(const photos::ScoredPhoto& photo);
  double Psnr() const;      // dB, mean over the photos; NaN when none has one
  double Coverage() const;  // covered share of all used pixels; NaN when none is used
  // All that Add has added, so that other Scores of the same boxes and roofs can go on from here. Load throws base::UnreadableBytes for another
  // number of boxes or roofs.
  void Save(base::BytePacker* out) const;
  void Load(base::ByteUnpacker* in);
};

// Metrics known before any photo is scored: survey, training, machine.
Metrics MetricsBeforeScoring(const EvaluateInput& input);
// Adds the values that follow from the scores, the cost of rendering so far, and the warnings.
void Summarise(const EvaluateInput& input, const Scores& scores, Metrics* metrics);

}  // namespace skyquilt::evaluate::metrics
