#include "core/encoding/voxel_grid.h"

#include "core/encoding/hash_grid.h"
#include "core/encoding/lattice.h"

namespace skyquilt::encoding {

VoxelGrid::VoxelGrid(const HashGridConfig& config) : features_(config.features) {
  const double points = static_cast<double>(HashGrid(config).ParameterCount()) / (config.levels * config.features);
  lattice_ = DenseLattice(config.extent, FinestResolutionWithinBudget(points, config.finest_resolution, [&](double resolution) {
                            return LatticePoints(DenseLattice(config.extent, resolution));
                          }));
  lattice_.entries = static_cast<uint32_t>(LatticePoints(lattice_));
  for (int part = 0; part < config.levels; ++part) AddPart(features_, static_cast<int64_t>(lattice_.entries) * features_);
}

void VoxelGrid::Forward(int /*part*/, const float* table, const kernel::Positions& at, int64_t n, float* out, size_t out_stride) const {
  kernel::HashForward(lattice_, features_, table, at, n, out, out_stride);
}

void VoxelGrid::Backward(int /*part*/, const float* /*table*/, const kernel::Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                         float* table_gradient, uint8_t* touched) const {
  kernel::HashBackward(lattice_, features_, at, n, out_gradient, out_stride, table_gradient, touched);
}

}  // namespace skyquilt::encoding
