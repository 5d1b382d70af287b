// Samplers that place the samples of a ray where an earlier pass along the same ray found matter, without an occupancy grid:
//   stratified: NeRF's coarse and fine passes (Mildenhall et al. 2020, section 5.2). One network for both passes: as the fine pass has the coarse
//               one's edges too, the network learns everywhere without a coarse loss.
//   proposal:   one small density field per pass proposes where the next pass samples, the last one where the field does (Barron et al. 2022,
//               mip-NeRF 360; nerfacto). They learn from the field by the interlevel loss (worker/losses/interlevel_loss.h).
// Same bits for any number of threads.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/base/thread_pool.h"
#include "core/render/trained_field.h"
#include "worker/phase_times.h"
#include "worker/samplers/proposal_network.h"
#include "worker/samplers/ray_bins.h"
#include "worker/step/step_taus.h"

namespace skyquilt::worker {

enum class Sampler { kOccupancy, kStratified, kProposal };
// "occupancy", "stratified", "proposal". Throws std::invalid_argument for others.
Sampler SamplerNamed(const std::string& name);
// `samples` per pass, of which the last is the field's; when it is empty, the sampler's own numbers: stratified 64 and 128 (NeRF), proposal 64, 64
// and 32 (Zip-NeRF).
std::vector<int> SamplesPerPass(Sampler sampler, const std::vector<double>& samples);

class BinSampler {
 public:
  static constexpr float kLeastLight = 5e-3F;

  // sampler: not kOccupancy. samples: per pass, at least two passes. jittered: false: the first pass has the same bins in every step. References must
  // outlive it.
  BinSampler(Sampler sampler, const std::vector<int>& samples, bool jittered, const render::TrainedField& target,
             const field::HashField& target_field, uint64_t seed, base::ThreadPool& threads, PhaseTimes& times);

  // Samples of a ray in the field's pass.
  int LastBins() const;
  // Empty for stratified.
  std::span<const std::unique_ptr<ProposalNetwork>> proposals() const { return proposals_; }
  void InitializeParameters();

  // Before the rays of a step are drawn, in n_groups groups. progress: of the training, 0..1.
  void Begin(double progress, int64_t n_groups);
  // The edges of the samples of all rays of a group, LastBins() + 1 per ray, valid until the next Begin, as the rays must be. Called once per group
  // and step; threads may do so at the same time.
  std::span<const float> Place(int64_t group, std::span<const BinnedRay> rays, base::Random& random, int thread);
  // After the field's step. weights: of the samples of all rays in the order of the groups, LastBins() per ray. Marks the cells of samples that take
  // more than a share of kLeastLight of a ray's light as `judged`: what else the field has there was never seen, and is not worth rendering.
  void MarkLit(std::span<const float> weights, field::OccupancyGrid& cells) const;
  // Whether the proposals learn in this step.
  bool Learns(double progress, int64_t step) const;
  // After the field's step, with the same weights.
  void Learn(std::span<const float> weights, double learning_rate);

 private:
  struct Group {
    std::vector<ProposalBins> passes;  // all but the last
    std::vector<float> edges;          // of the last
    std::span<const BinnedRay> rays;
  };
  struct Scratch {
    StepTaus evaluator;
    std::vector<float> weights;
  };
  // From the edges: middles and lengths.
  void FindMiddles(std::span<const BinnedRay> rays, ProposalBins& b) const;
  void Evaluate(size_t pass, ProposalBins& b, int thread);

  Sampler sampler_;
  std::vector<int> samples_;
  bool jittered_;
  const render::TrainedField& target_;
  const field::HashField& field_;
  uint64_t seed_;
  PhaseTimes& times_;
  std::vector<std::unique_ptr<ProposalNetwork>> proposals_;
  field::NetworkWeights weights_;  // of the field, for stratified
  double anneal_ = 1.0;
  std::vector<Group> groups_;
  std::vector<Scratch> scratch_;  // per thread
};

}  // namespace skyquilt::worker
