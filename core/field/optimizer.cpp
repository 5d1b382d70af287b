#include "core/field/optimizer.h"

#include <algorithm>
#include <cmath>

#include "core/base/system.h"

namespace skyquilt::field {
namespace {

// Random access to tables of megabytes misses the TLB at every corner on pages of 4 KiB.
void AssignTable(std::vector<float>* table, size_t n) {
  table->clear();
  table->reserve(n);
  base::AdviseHugePages(table->data(), n * sizeof(float));
  table->assign(n, 0.0F);
}

}  // namespace

void TrainableState::Allocate(const HashField& field) {
  const auto grid_size = static_cast<size_t>(field.GridParameters());
  const auto network_size = static_cast<size_t>(field.NetworkParameters());
  for (auto* buffer : {&grid, &grid_moment1, &grid_moment2}) AssignTable(buffer, grid_size);
  for (auto* buffer : {&networks, &network_moment1, &network_moment2, &network_gradient}) buffer->assign(network_size, 0.0F);
  step = 0;
}

void AddLevelGradient(const HashField& field, int level, const float* x, const float* y, const float* z, std::span<const GridGradient> stretches,
                      float* table_gradient, uint8_t* touched) {
  const encoding::HashGrid& grid = field.grid();
  for (const GridGradient& s : stretches) {
    kernel::HashBackward(grid.level(level), grid.features(), x + s.begin, y + s.begin, z + s.begin, s.count,
                         s.gradient + static_cast<size_t>(level * grid.features()) * s.stride, s.stride, table_gradient, touched);
  }
}

Optimizer::Optimizer(const HashField& field, base::ThreadPool& threads)
    : field_(field), threads_(threads), scratch_(static_cast<size_t>(threads.size())) {}

void Optimizer::Update(const float* x, const float* y, const float* z, std::span<const GridGradient> stretches, double learning_rate,
                       double network_l2, TrainableState& state, const TaskClock& scattered, const TaskClock& applied) {
  ++state.step;
  kernel::AdamStep step;
  const auto t = static_cast<double>(state.step);
  step.learning_rate = static_cast<float>(learning_rate);
  step.correction1 = static_cast<float>(1.0 - std::pow(static_cast<double>(step.beta1), t));
  step.correction2 = static_cast<float>(1.0 - std::pow(static_cast<double>(step.beta2), t));
  kernel::AdamDense(step, static_cast<float>(network_l2), field_.NetworkParameters(), state.networks.data(), state.network_gradient.data(),
                    state.network_moment1.data(), state.network_moment2.data());
  const encoding::HashGrid& grid = field_.grid();
  int64_t largest = 0;
  for (int l = 0; l < grid.levels(); ++l) largest = std::max(largest, grid.Offset(l + 1) - grid.Offset(l));
  threads_.ParallelFor(grid.levels(), [&](int64_t task, int thread) {
    LevelScratch& scratch = scratch_[static_cast<size_t>(thread)];
    if (scratch.gradient.empty()) {
      AssignTable(&scratch.gradient, static_cast<size_t>(largest));
      scratch.touched.assign(static_cast<size_t>(largest / kernel::kLineFloats), 0);
    }
    // The finest levels cost most: start with them.
    const int l = grid.levels() - 1 - static_cast<int>(task);
    const auto began = std::chrono::steady_clock::now();
    AddLevelGradient(field_, l, x, y, z, stretches, scratch.gradient.data(), scratch.touched.data());
    if (scattered) scattered(thread, began);
    const auto then = std::chrono::steady_clock::now();
    const int64_t offset = grid.Offset(l);
    kernel::AdamTouched(step, (grid.Offset(l + 1) - offset) / kernel::kLineFloats, scratch.touched.data(), state.grid.data() + offset,
                        scratch.gradient.data(), state.grid_moment1.data() + offset, state.grid_moment2.data() + offset);
    if (applied) applied(thread, then);
  });
}

}  // namespace skyquilt::field
