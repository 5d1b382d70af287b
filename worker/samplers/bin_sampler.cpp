#include "worker/samplers/bin_sampler.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "worker/rays/ray_batch.h"

namespace skyquilt::worker {
namespace {

// Resolutions of the proposal fields as shares of the field's, and the blur of their loss as a share of a ray (Zip-NeRF: 512 and 2048 of 8192; 0.03
// and 0.003). With more than two proposals, the others are like the last.
constexpr double kResolutionShares[] = {1.0 / 16.0, 1.0 / 4.0};
constexpr double kHalfWidths[] = {0.03, 0.003};
// Share of the edges that are spread evenly: what proposals have lost comes back only where it is sampled. NeRF's coarse samples are even themselves.
constexpr double kUniformShareOfProposals = 0.1, kUniformShareOfStratified = 1e-3;
// Early proposals are wrong, so the first edges are spread more widely: the weights to the power 10 p / (9 p + 1) (mip-NeRF 360, appendix).
constexpr double kAnnealSlope = 10.0;
// Proposals learn in every step at first and in every fifth from half of the training on, as in nerfacto: then they change little.
constexpr double kLearnSeldomFrom = 0.5;
constexpr double kMostSeldom = 5.0;
constexpr uint64_t kProposalStream = 7;

}  // namespace

Sampler SamplerNamed(const std::string& name) {
  if (name == "occupancy") return Sampler::kOccupancy;
  if (name == "stratified") return Sampler::kStratified;
  if (name == "proposal") return Sampler::kProposal;
  throw std::invalid_argument("unknown sampler '" + name + "': choose occupancy, stratified or proposal");
}

std::vector<int> SamplesPerPass(Sampler sampler, const std::vector<double>& samples) {
  if (samples.empty()) return sampler == Sampler::kStratified ? std::vector<int>{64, 128} : std::vector<int>{64, 64, 32};
  std::vector<int> passes;
  for (const double n : samples) passes.push_back(static_cast<int>(n));
  return passes;
}

BinSampler::BinSampler(Sampler sampler, const std::vector<int>& samples, bool jittered, const render::TrainedField& target,
                       const field::HashField& target_field, uint64_t seed, base::ThreadPool& threads, PhaseTimes& times)
    : sampler_(sampler),
      samples_(samples),
      jittered_(jittered),
      target_(target),
      field_(target_field),
      seed_(seed),
      times_(times),
      scratch_(static_cast<size_t>(threads.size())) {
  if (sampler != Sampler::kProposal) return;
  for (size_t pass = 0; pass + 1 < samples.size(); ++pass) {
    const size_t like = std::min(pass, std::size(kHalfWidths) - 1);
    proposals_.push_back(std::make_unique<ProposalNetwork>(target.config, kResolutionShares[like], kHalfWidths[like], threads));
  }
}

int BinSampler::LastBins() const {
  // The fine pass has the coarse one's edges, too.
  return sampler_ == Sampler::kStratified ? samples_[0] + samples_[1] + 1 : samples_.back();
}

void BinSampler::InitializeParameters() {
  for (size_t i = 0; i < proposals_.size(); ++i) {
    base::Random random(MixSeed(seed_, 0, i), kProposalStream);
    proposals_[i]->Initialize(random);
  }
}

void BinSampler::Begin(double progress, int64_t n_groups) {
  const double p = std::clamp(progress, 0.0, 1.0);
  anneal_ = sampler_ == Sampler::kProposal ? kAnnealSlope * p / ((kAnnealSlope - 1.0) * p + 1.0) : 1.0;
  for (const auto& proposal : proposals_) proposal->Prepare();
  if (sampler_ == Sampler::kStratified) weights_ = field_.Prepare(target_.parameters.networks);
  groups_.resize(static_cast<size_t>(n_groups));
}

void BinSampler::FindMiddles(std::span<const BinnedRay> rays, ProposalBins& b) const {
  const auto bins = static_cast<size_t>(b.bins);
  for (auto* v : {&b.x, &b.y, &b.z, &b.unit_length, &b.tau}) v->resize(rays.size() * bins);
  for (size_t r = 0; r < rays.size(); ++r) {
    const RayPlaces places(target_, rays[r]);
    for (size_t k = 0; k < bins; ++k) {
      const float* const edge = &b.edges[r * (bins + 1) + k];
      const RayPlaces::Bin bin = places.Of(static_cast<double>(edge[0]), static_cast<double>(edge[1]));
      const Eigen::Vector3f at = target_.map.UnitFromEnu(rays[r].origin_enu + bin.t * rays[r].direction_enu);
      const size_t i = r * bins + k;
      b.x[i] = at.x();
      b.y[i] = at.y();
      b.z[i] = at.z();
      b.unit_length[i] = static_cast<float>(bin.unit_length_m / target_.step_m);
    }
  }
}

void BinSampler::Evaluate(size_t pass, ProposalBins& b, int thread) {
  const auto n = static_cast<int64_t>(b.x.size());
  const kernel::Positions at{b.x.data(), b.y.data(), b.z.data()};
  StepTaus& evaluator = scratch_[static_cast<size_t>(thread)].evaluator;
  if (proposals_.empty()) {
    evaluator.Evaluate(field_, weights_, target_.parameters.grid, at, n, b.tau.data());
  } else {
    const ProposalNetwork& proposal = *proposals_[pass];
    evaluator.Evaluate(proposal.field(), proposal.weights(), proposal.parameters().grid, at, n, b.tau.data());
  }
  for (size_t i = 0; i < b.tau.size(); ++i) b.tau[i] *= b.unit_length[i];
}

std::span<const float> BinSampler::Place(int64_t group, std::span<const BinnedRay> rays, base::Random& random, int thread) {
  Group& g = groups_[static_cast<size_t>(group)];
  Scratch& scratch = scratch_[static_cast<size_t>(thread)];
  const double uniform_share = proposals_.empty() ? kUniformShareOfStratified : kUniformShareOfProposals;
  const auto jitter = [&] { return jittered_ ? random.Uniform() : 0.5F; };
  g.rays = rays;
  g.passes.resize(samples_.size() - 1);
  const auto last = static_cast<size_t>(LastBins());
  g.edges.resize(rays.size() * (last + 1));
  for (size_t pass = 0; pass < samples_.size(); ++pass) {
    const bool is_last = pass + 1 == samples_.size();
    const size_t bins = static_cast<size_t>(samples_[pass]), stride = is_last ? last + 1 : bins + 1;
    std::vector<float>& edges = is_last ? g.edges : g.passes[pass].edges;
    edges.resize(rays.size() * stride);
    for (size_t r = 0; r < rays.size(); ++r) {
      const std::span<float> mine(edges.data() + r * stride, stride);
      if (pass == 0) {
        EvenEdges(jitter(), mine);
        continue;
      }
      const ProposalBins& before = g.passes[pass - 1];
      const auto known = static_cast<size_t>(before.bins);
      const std::span<const float> known_edges(before.edges.data() + r * (known + 1), known + 1);
      scratch.weights.resize(known);
      WeightsOfTaus(std::span<const float>(before.tau.data() + r * known, known), scratch.weights.data());
      ResampleEdges(known_edges, scratch.weights, anneal_, uniform_share, jitter(), mine.first(bins + 1));
      if (!proposals_.empty()) continue;
      std::copy(known_edges.begin(), known_edges.end(), mine.begin() + static_cast<ptrdiff_t>(bins) + 1);
      std::sort(mine.begin(), mine.end());
    }
    if (is_last) break;
    g.passes[pass].bins = samples_[pass];
    FindMiddles(rays, g.passes[pass]);
    Evaluate(pass, g.passes[pass], thread);
  }
  return g.edges;
}

void BinSampler::MarkLit(std::span<const float> weights, field::OccupancyGrid& cells) const {
  const auto last = static_cast<size_t>(LastBins());
  const auto cell = static_cast<double>(cells.cell);
  size_t sample = 0;
  for (const Group& group : groups_) {
    for (size_t r = 0; r < group.rays.size(); ++r) {
      const BinnedRay& ray = group.rays[r];
      const RayPlaces places(target_, ray);
      for (size_t k = 0; k < last; ++k) {
        if (!(weights[sample++] > kLeastLight)) continue;
        const float* const edge = &group.edges[r * (last + 1) + k];
        const RayPlaces::Bin bin = places.Of(static_cast<double>(edge[0]), static_cast<double>(edge[1]));
        const int steps = 1 + static_cast<int>(bin.unit_length_m * target_.map.units_per_metre() / cell);
        for (int i = 0; i < steps; ++i) {
          const double t = bin.t + bin.length_m * ((i + 0.5) / steps - 0.5);
          const Eigen::Vector3f at = target_.map.UnitFromEnu(ray.origin_enu + t * ray.direction_enu);
          cells.judged[static_cast<size_t>(cells.IndexAt(at.x(), at.y(), at.z()))] = 1;
        }
      }
    }
  }
}

bool BinSampler::Learns(double progress, int64_t step) const {
  if (proposals_.empty()) return false;
  const double seldom = 1.0 + (kMostSeldom - 1.0) * std::min(1.0, progress / kLearnSeldomFrom);
  return step % static_cast<int64_t>(seldom) == 0;
}

void BinSampler::Learn(std::span<const float> weights, double learning_rate) {
  const auto start = PhaseTimes::Clock::now();
  const auto last = static_cast<size_t>(LastBins());
  std::vector<ProposalNetwork::Found> found(groups_.size());
  for (size_t pass = 0; pass < proposals_.size(); ++pass) {
    size_t ray = 0;
    for (size_t g = 0; g < groups_.size(); ++g) {
      const size_t rays = groups_[g].edges.size() / (last + 1);
      found[g] = {&groups_[g].passes[pass], static_cast<int>(last), groups_[g].edges, weights.subspan(ray * last, rays * last)};
      ray += rays;
    }
    proposals_[pass]->Learn(found, learning_rate);
  }
  times_.Add(0, Phase::kSampler, start);
}

}  // namespace skyquilt::worker
