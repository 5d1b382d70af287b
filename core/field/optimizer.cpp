#include "core/field/optimizer.h"

#include <algorithm>
#include <cmath>

namespace skyquilt::field {

void OptimizerState::Allocate(const HashField& field) {
  const auto grid_size = static_cast<size_t>(field.GridParameters());
  const auto network_size = static_cast<size_t>(field.NetworkParameters());
  for (auto* buffer : {&grid_moment1, &grid_moment2}) AssignTable(buffer, grid_size);
  for (auto* buffer : {&network_moment1, &network_moment2, &network_gradient}) buffer->assign(network_size, 0.0F);
  step = 0;
  network_gradient_norm = 0.0;
}

void AddPartGradient(const HashField& field, int part, const float* table, const kernel::Positions& at, std::span<const FeatureGradient> segments,
                     float* table_gradient, uint8_t* touched) {
  const auto first_row = static_cast<size_t>(field.encoding().FirstRow(part));
  for (const FeatureGradient& s : segments) {
    const kernel::Positions places = (s.at != nullptr ? *s.at : at).From(s.begin);
    const float* const gradient = s.gradient + first_row * s.stride;
    if (s.along != nullptr) {
      field.encoding().TangentBackward(part, places, s.count, s.along, s.stride, gradient, s.stride, table_gradient, touched);
    } else {
      field.encoding().Backward(part, table, places, s.count, gradient, s.stride, table_gradient, touched);
    }
  }
}

Optimizer::Optimizer(const HashField& field, base::ThreadPool& threads)
    : field_(field), threads_(threads), scratch_(static_cast<size_t>(threads.size())) {}

void Optimizer::Update(const kernel::Positions& at, std::span<const FeatureGradient> segments, double learning_rate, double network_l2,
                       Parameters& parameters, OptimizerState& state, const TaskClock& scattered, const TaskClock& applied) {
  ++state.step;
  kernel::AdamStep step;
  const auto t = static_cast<double>(state.step);
  step.learning_rate = static_cast<float>(learning_rate);
  step.correction1 = static_cast<float>(1.0 - std::pow(static_cast<double>(step.beta1), t));
  step.correction2 = static_cast<float>(1.0 - std::pow(static_cast<double>(step.beta2), t));
  kernel::AdamDense(step, static_cast<float>(network_l2), field_.NetworkParameters(), parameters.networks.data(), state.network_gradient.data(),
                    state.network_moment1.data(), state.network_moment2.data());
  const encoding::Encoding& encoding = field_.encoding();
  if (encoding.ParameterCount() == 0) return;
  int64_t largest = 0;
  for (int part = 0; part < encoding.parts(); ++part) largest = std::max(largest, encoding.Offset(part + 1) - encoding.Offset(part));
  threads_.ParallelFor(encoding.parts(), [&](int64_t task, int thread) {
    PartScratch& scratch = scratch_[static_cast<size_t>(thread)];
    if (scratch.gradient.empty()) {
      AssignTable(&scratch.gradient, static_cast<size_t>(largest));
      scratch.touched.assign(static_cast<size_t>(largest / kernel::kLineFloats), 0);
    }
    // The last parts, a hash grid's finest levels, take longest: start with them.
    const int part = encoding.parts() - 1 - static_cast<int>(task);
    const int64_t offset = encoding.Offset(part);
    float* table = parameters.grid.data() + offset;
    const auto began = std::chrono::steady_clock::now();
    AddPartGradient(field_, part, table, at, segments, scratch.gradient.data(), scratch.touched.data());
    if (scattered) scattered(thread, began);
    const auto then = std::chrono::steady_clock::now();
    kernel::AdamTouched(step, (encoding.Offset(part + 1) - offset) / kernel::kLineFloats, scratch.touched.data(), table, scratch.gradient.data(),
                        state.grid_moment1.data() + offset, state.grid_moment2.data() + offset);
    if (applied) applied(thread, then);
  });
}

}  // namespace skyquilt::field
