#include "core/field/optimizer.h"

#include <algorithm>
#include <cmath>

#include "core/base/system.h"

namespace skyquilt::field {

void TrainableState::Allocate(const HashField& field) {
  const auto grid_size = static_cast<size_t>(field.GridParameters());
  const auto network_size = static_cast<size_t>(field.NetworkParameters());
  for (auto* buffer : {&grid, &grid_moment1, &grid_moment2, &grid_gradient}) {
    buffer->clear();
    buffer->reserve(grid_size);
    // Random access to tables of megabytes misses the TLB at every corner on pages of 4 KiB.
    base::AdviseHugePages(buffer->data(), grid_size * sizeof(float));
    buffer->assign(grid_size, 0.0F);
  }
  for (auto* buffer : {&networks, &network_moment1, &network_moment2, &network_gradient}) buffer->assign(network_size, 0.0F);
  touched.assign(grid_size / kernel::kLineFloats, 0);
  step = 0;
}

void AccumulateGrid(const HashField& field, const float* x, const float* y, const float* z, std::span<const GridGradient> stretches,
                    TrainableState& state, base::ThreadPool& threads, const TaskClock& clock) {
  const encoding::HashGrid& grid = field.grid();
  threads.ParallelFor(grid.levels(), [&](int64_t task, int thread) {
    const auto began = std::chrono::steady_clock::now();
    // The finest levels cost most: start with them.
    const int l = grid.levels() - 1 - static_cast<int>(task);
    for (const GridGradient& s : stretches) {
      kernel::HashBackward(grid.level(l), grid.features(), x + s.begin, y + s.begin, z + s.begin, s.count,
                           s.gradient + static_cast<size_t>(l * grid.features()) * s.stride, s.stride, state.grid_gradient.data() + grid.Offset(l),
                           state.touched.data() + grid.Offset(l) / kernel::kLineFloats);
    }
    if (clock) clock(thread, began);
  });
}

void ApplyAdam(const HashField& field, double learning_rate, double network_l2, TrainableState& state, base::ThreadPool& threads,
               const TaskClock& clock) {
  ++state.step;
  kernel::AdamStep step;
  const auto t = static_cast<double>(state.step);
  step.learning_rate = static_cast<float>(learning_rate);
  step.correction1 = static_cast<float>(1.0 - std::pow(static_cast<double>(step.beta1), t));
  step.correction2 = static_cast<float>(1.0 - std::pow(static_cast<double>(step.beta2), t));
  const encoding::HashGrid& grid = field.grid();
  threads.ParallelFor(grid.levels() + 1, [&](int64_t task, int thread) {
    const auto began = std::chrono::steady_clock::now();
    if (task == grid.levels()) {
      kernel::AdamDense(step, static_cast<float>(network_l2), field.NetworkParameters(), state.networks.data(), state.network_gradient.data(),
                        state.network_moment1.data(), state.network_moment2.data());
      return;
    }
    const int l = grid.levels() - 1 - static_cast<int>(task);
    const int64_t offset = grid.Offset(l);
    kernel::AdamTouched(step, (grid.Offset(l + 1) - offset) / kernel::kLineFloats, state.touched.data() + offset / kernel::kLineFloats,
                        state.grid.data() + offset, state.grid_gradient.data() + offset, state.grid_moment1.data() + offset,
                        state.grid_moment2.data() + offset);
    if (clock) clock(thread, began);
  });
}

void DropGradients(TrainableState& state) {
  std::fill(state.grid_gradient.begin(), state.grid_gradient.end(), 0.0F);
  std::fill(state.network_gradient.begin(), state.network_gradient.end(), 0.0F);
  std::fill(state.touched.begin(), state.touched.end(), uint8_t{0});
}

}  // namespace skyquilt::field
