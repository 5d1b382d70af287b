#include "worker/good_state.h"

#include <algorithm>
#include <utility>

namespace skyquilt::worker {
namespace {

// Into the buffers that are there: the field's tables are on huge pages.
template <typename T>
void CopyInto(const std::vector<T>& from, std::vector<T>& to) {
  to.resize(from.size());
  std::copy(from.begin(), from.end(), to.begin());
}

void CopyInto(const std::vector<bool>& from, std::vector<bool>& to) {
  to = from;
}

void CopyInto(const field::Parameters& from, field::Parameters& to) {
  CopyInto(from.grid, to.grid);
  CopyInto(from.networks, to.networks);
}

// The gradient is zero between steps.
void CopyInto(const field::OptimizerState& from, field::OptimizerState& to) {
  CopyInto(from.grid_moment1, to.grid_moment1);
  CopyInto(from.grid_moment2, to.grid_moment2);
  CopyInto(from.network_moment1, to.network_moment1);
  CopyInto(from.network_moment2, to.network_moment2);
  CopyInto(from.network_gradient, to.network_gradient);
  to.step = from.step;
  to.network_gradient_norm = from.network_gradient_norm;
}

}  // namespace

int64_t GoodState::Interval(int64_t parameters, int batch) {
  const int64_t steps = std::clamp<int64_t>(parameters / (2 * std::max(1, batch)), 2 * FallGuard::kWindow, 512);
  return (steps + FallGuard::kWindow - 1) / FallGuard::kWindow * FallGuard::kWindow;
}

std::span<const std::unique_ptr<ProposalNetwork>> GoodState::Proposals() const {
  if (trainer_.sampler() == nullptr) return {};
  return trainer_.sampler()->proposals();
}

void GoodState::Keep() {
  const std::span<const std::unique_ptr<ProposalNetwork>> proposals = Proposals();
  proposals_.resize(proposals.size());
  proposal_optimizers_.resize(proposals.size());
  for (size_t i = 0; i < proposals.size(); ++i) {
    CopyInto(proposals[i]->parameters(), proposals_[i]);
    CopyInto(proposals[i]->state(), proposal_optimizers_[i]);
  }
  CopyInto(field_.parameters, parameters_);
  CopyInto(trainer_.state(), optimizer_);
  CopyInto(field_.occupancy.tau, tau_);
  CopyInto(field_.occupancy.occupied, occupied_);
  CopyInto(field_.occupancy.judged, judged_);
  rays_per_step_ = trainer_.rays_per_step();
  luminance_ = trainer_.luminance_state();
  codes_ = trainer_.codes().state();
  if (trainer_.poses() != nullptr) poses_ = trainer_.poses()->state();
  kept_record_ = record_;
  if (extras_ != nullptr) {
    response_ = *extras_->response;
    moments_ = extras_->learner->moments();
  }
  empty_ = false;
}

void GoodState::Restore() {
  const std::span<const std::unique_ptr<ProposalNetwork>> proposals = Proposals();
  for (size_t i = 0; i < proposals.size(); ++i) {
    CopyInto(proposals_[i], proposals[i]->parameters());
    CopyInto(proposal_optimizers_[i], proposals[i]->state());
  }
  CopyInto(parameters_, field_.parameters);
  CopyInto(optimizer_, trainer_.state());
  CopyInto(tau_, field_.occupancy.tau);
  CopyInto(occupied_, field_.occupancy.occupied);
  CopyInto(judged_, field_.occupancy.judged);
  trainer_.rays_per_step() = rays_per_step_;
  trainer_.luminance_state() = luminance_;
  trainer_.codes().state() = codes_;
  if (trainer_.poses() != nullptr) {
    trainer_.poses()->state() = poses_;
    trainer_.UpdatePoses();
  }
  record_.mean_squared_error = kept_record_.mean_squared_error;
  record_.guard = kept_record_.guard;
  if (extras_ != nullptr) {
    *extras_->response = response_;
    extras_->learner->moments() = moments_;
    trainer_.UpdateExposures();
  }
}

void GoodState::Exchange() {
  const std::span<const std::unique_ptr<ProposalNetwork>> proposals = Proposals();
  for (size_t i = 0; i < proposals.size(); ++i) {
    std::swap(proposals_[i], proposals[i]->parameters());
    std::swap(proposal_optimizers_[i], proposals[i]->state());
  }
  std::swap(parameters_, field_.parameters);
  std::swap(optimizer_, trainer_.state());
  std::swap(tau_, field_.occupancy.tau);
  std::swap(occupied_, field_.occupancy.occupied);
  std::swap(judged_, field_.occupancy.judged);
  std::swap(rays_per_step_, trainer_.rays_per_step());
  std::swap(luminance_, trainer_.luminance_state());
  std::swap(codes_, trainer_.codes().state());
  if (trainer_.poses() != nullptr) std::swap(poses_, trainer_.poses()->state());
  std::swap(kept_record_, record_);
  if (extras_ != nullptr) {
    std::swap(response_, *extras_->response);
    std::swap(moments_, extras_->learner->moments());
  }
}

void GoodState::With(const std::function<void()>& use) {
  struct Back {
    GoodState& state;
    ~Back() { state.Exchange(); }
  };
  Exchange();
  const Back back{*this};
  use();
}

}  // namespace skyquilt::worker
