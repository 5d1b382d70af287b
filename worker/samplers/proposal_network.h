// A small density field that proposes where along a ray the next pass samples: a hash grid of a part of the field's resolution and a narrow network.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/thread_pool.h"
#include "core/field/optimizer.h"
#include "core/render/trained_field.h"
#include "worker/losses/interlevel_loss.h"

namespace skyquilt::worker {

// The bins of the rays of one group in one pass: `bins` per ray, one ray after the other.
struct ProposalBins {
  int bins = 0;
  std::vector<float> edges;        // bins + 1 per ray, shares of the ray
  std::vector<float> x, y, z;      // middles, unit frame
  std::vector<float> unit_length;  // marching steps
  std::vector<float> tau;          // optical depths of the bins
};

class ProposalNetwork {
 public:
  // resolution_share: of the field's finest resolution. half_width: of the blur in its interlevel loss, share of a ray.
  ProposalNetwork(const field::FieldConfig& of_field, double resolution_share, double half_width, base::ThreadPool& threads);

  const field::HashField& field() const { return field_; }
  const field::NetworkWeights& weights() const { return weights_; }
  field::Parameters& parameters() { return parameters_; }
  const field::Parameters& parameters() const { return parameters_; }
  field::OptimizerState& state() { return state_; }
  void Initialize(base::Random& random) { field_.Initialize(random, parameters_.grid, parameters_.networks); }
  // Makes weights() from the parameters.
  void Prepare() { weights_ = field_.Prepare(parameters_.networks); }

  // What the field found along the rays of one group: `bins` bins per ray.
  struct Found {
    const ProposalBins* own = nullptr;
    int bins = 0;
    std::span<const float> edges, weights;  // bins + 1 and bins per ray
  };
  // One step towards what the field found, with the mean interlevel loss of all rays. Returns that loss. A step that is not finite changes nothing.
  double Learn(std::span<const Found> groups, double learning_rate);

 private:
  struct Scratch {
    field::Activations a;
    InterlevelScratch blur;
    std::vector<double> mass;
    std::vector<float> weights, weight_gradient;
  };
  // A run of whole rays of a group, which one thread computes while it is in cache.
  struct Run {
    size_t group = 0;
    int64_t first_ray = 0, rays = 0;
    size_t stride = 0, features = 0;  // of its features in features_
  };
  std::vector<Run> Runs(std::span<const Found> groups);
  double LearnRun(const Found& found, const Run& run, float ray_share, Scratch& scratch, float* network_gradient);

  field::HashField field_;
  double half_width_;
  base::ThreadPool& threads_;
  field::Parameters parameters_;
  field::OptimizerState state_;
  field::Optimizer optimizer_;
  field::NetworkWeights weights_;
  std::vector<float> features_, slot_gradients_;
  std::vector<Scratch> scratch_;  // per thread
};

}  // namespace skyquilt::worker
