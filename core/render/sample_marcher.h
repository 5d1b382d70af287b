// Places the samples of rays in all fields that they pass, with their blend weights.
#pragma once

#include <vector>

#include "core/render/ground_index.h"
#include "core/render/ray_engine.h"

namespace skyquilt::render {

struct Sample {
  double t;
  float length, unit_length, blend;
  float x, y, z;  // unit frame of its field
  bool odd;       // every other sample of its ray and field
  int field;
  float weight;  // compositing weight
  int local;     // index in its field's batch
};

// Not thread-safe.
class SampleMarcher {
 public:
  // The fields must outlive it. A sample's `field` counts the blocks in order, then the context.
  SampleMarcher(const FieldSet& fields, double step_scale);

  // Appends the samples of a ray inside a window, in order of distance. They are at the same places as without a window.
  void March(const Ray& ray, const Window& window, std::vector<Sample>* samples);

 private:
  // Where a ray may have samples at all.
  geo::Interval Reach(const Ray& ray) const;
  void CutCore(const TrainedField& f, const Ray& ray);
  // Sets here_ to the candidates that may have a weight at a distance: others have none, so that the weights are the same without them.
  void FindHere(const Ray& ray, double t);
  double StepScale(const Ray& ray, const TrainedField& f, const geo::Interval& interval) const;
  bool MarchField(const Ray& ray, const Window& window, int k, const geo::Interval& interval, std::vector<Sample>* samples);

  FieldSet fields_;
  std::vector<const TrainedField*> all_;
  GroundIndex index_;
  int context_index_ = 0;
  double step_scale_ = 1.0;
  // Workspace of one ray.
  std::vector<geo::Interval> gaps_;   // intervals where the context is marched
  std::vector<int> candidates_;       // blocks, ascending
  std::vector<geo::Interval> ramps_;  // of the candidates: where they may have a weight; empty until a sample is blended
  std::vector<int> here_;             // the candidates at distances in [here_from_, here_to_)
  double here_from_ = 0.0, here_to_ = 0.0;
  std::vector<double> block_weights_;  // of here_
};

}  // namespace skyquilt::render
