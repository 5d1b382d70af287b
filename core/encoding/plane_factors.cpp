#include "core/encoding/plane_factors.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/encoding/hash_grid.h"
#include "core/encoding/lattice.h"

namespace skyquilt::encoding {
namespace {

constexpr int kPlaneBlock = 256;

// The two lattice points next to a position along one axis: the lower one, and the weight of the upper one.
struct Cell {
  int32_t low;
  float fraction;
};

Cell CellAt(float position, float cells_per_unit, int32_t points) {
  const float scaled = position * cells_per_unit;
  const float inside = scaled > 0.0F ? std::min(scaled, static_cast<float>(points - 1)) : 0.0F;
  const int32_t low = std::min(static_cast<int32_t>(inside), points - 2);
  return {low, inside - static_cast<float>(low)};
}

double FactorEntries(const kernel::GridLevel& lattice) {
  const double x = lattice.size[0], y = lattice.size[1], z = lattice.size[2];
  return x * y + y * z + z * x + x + y + z;
}

using Group = Eigen::Array<float, PlaneFactors::kGroup, 1>;

Eigen::Map<const Group> EntryAt(const float* table, int64_t entry) {
  return Eigen::Map<const Group>(table + entry * PlaneFactors::kGroup);
}

}  // namespace

// Table entries and interpolation weights for up to kPlaneBlock samples.
struct PlaneFactors::Block {
  int64_t plane[kPlaneBlock][4];
  float plane_weight[kPlaneBlock][4];
  int64_t line[kPlaneBlock];  // the lower entry; the upper one is the next
  float line_weight[kPlaneBlock][2];

  Group Plane(const float* table, int s) const {
    Group sum = plane_weight[s][0] * EntryAt(table, plane[s][0]);
    for (int k = 1; k < 4; ++k) sum += plane_weight[s][k] * EntryAt(table, plane[s][k]);
    return sum;
  }
  Group Line(const float* table, int s) const {
    return line_weight[s][0] * EntryAt(table, line[s]) + line_weight[s][1] * EntryAt(table, line[s] + 1);
  }
};

PlaneFactors::PlaneFactors(const HashGridConfig& config)
    : groups_(std::max(1, static_cast<int>(std::lround(config.levels * config.features / (3.0 * kGroup))))) {
  const double entries = static_cast<double>(HashGrid(config).ParameterCount()) / (groups_ * kGroup);
  lattice_ = DenseLattice(config.extent, FinestResolutionWithinBudget(entries, config.finest_resolution, [&](double resolution) {
                            return FactorEntries(DenseLattice(config.extent, resolution));
                          }));
  for (int part = 0; part < 3 * groups_; ++part) AddPart(kGroup, (PlaneEntries(part) + lattice_.size[part / groups_]) * kGroup);
}

PlaneFactors::Axes PlaneFactors::AxesOf(int part) const {
  const int w = part / groups_;
  return {w == 0 ? 1 : 0, w == 2 ? 1 : 2, w};
}

int64_t PlaneFactors::PlaneEntries(int part) const {
  const Axes axes = AxesOf(part);
  return static_cast<int64_t>(lattice_.size[axes.u]) * lattice_.size[axes.v];
}

void PlaneFactors::Initialize(base::Random& random, std::span<float> parameters) const {
  Encoding::Initialize(random, parameters);
  for (int part = 0; part < parts(); ++part) {
    std::fill_n(parameters.data() + Offset(part) + PlaneEntries(part) * kGroup, lattice_.size[AxesOf(part).w] * kGroup, 1.0F);
  }
}

void PlaneFactors::FindEntries(int part, const kernel::Positions& at, int j, int64_t begin, int count, Block& block) const {
  const kernel::Positions here = at.From(static_cast<int64_t>(static_cast<size_t>(j) * at.plane) + begin);
  const float* const position[3] = {here.x, here.y, here.z};
  const float share = 1.0F / static_cast<float>(at.points);
  const Axes axes = AxesOf(part);
  const int32_t width = lattice_.size[axes.u];
  const int64_t first_line = PlaneEntries(part);
  for (int s = 0; s < count; ++s) {
    const Cell u = CellAt(position[axes.u][s], lattice_.cells_per_unit, width);
    const Cell v = CellAt(position[axes.v][s], lattice_.cells_per_unit, lattice_.size[axes.v]);
    const Cell w = CellAt(position[axes.w][s], lattice_.cells_per_unit, lattice_.size[axes.w]);
    const int64_t corner = u.low + static_cast<int64_t>(v.low) * width;
    const float cone = at.sharpness != nullptr ? share * kernel::FootprintWeight(at.sharpness[begin + s], lattice_.cells_per_unit) : share;
    const float weight_u[2] = {cone * (1.0F - u.fraction), cone * u.fraction};
    const float weight_v[2] = {1.0F - v.fraction, v.fraction};
    for (int k = 0; k < 4; ++k) {
      block.plane[s][k] = corner + (k & 1) + (k >> 1) * width;
      block.plane_weight[s][k] = weight_u[k & 1] * weight_v[k >> 1];
    }
    block.line[s] = first_line + w.low;
    block.line_weight[s][0] = 1.0F - w.fraction;
    block.line_weight[s][1] = w.fraction;
  }
}

void PlaneFactors::Forward(int part, const float* table, const kernel::Positions& at, int64_t n, float* out, size_t out_stride) const {
  Block block;
  for (int64_t begin = 0; begin < n; begin += kPlaneBlock) {
    const int count = static_cast<int>(std::min<int64_t>(kPlaneBlock, n - begin));
    for (int j = 0; j < at.points; ++j) {
      FindEntries(part, at, j, begin, count, block);
      for (int s = 0; s < count; ++s) {
        const Group product = block.Plane(table, s) * block.Line(table, s);
        for (int c = 0; c < kGroup; ++c) {
          float& feature = out[static_cast<size_t>(c) * out_stride + static_cast<size_t>(begin + s)];
          feature = j == 0 ? product[c] : feature + product[c];
        }
      }
    }
  }
}

void PlaneFactors::Backward(int part, const float* table, const kernel::Positions& at, int64_t n, const float* out_gradient, size_t out_stride,
                            float* table_gradient, uint8_t* touched) const {
  constexpr int64_t kEntriesPerLine = kernel::kLineFloats / kGroup;
  Block block;
  const auto add = [&](int64_t entry, float weight, const Group& gradient) {
    Eigen::Map<Group>(table_gradient + entry * kGroup) += weight * gradient;
    touched[entry / kEntriesPerLine] = 1;
  };
  for (int64_t begin = 0; begin < n; begin += kPlaneBlock) {
    const int count = static_cast<int>(std::min<int64_t>(kPlaneBlock, n - begin));
    for (int j = 0; j < at.points; ++j) {
      FindEntries(part, at, j, begin, count, block);
      for (int s = 0; s < count; ++s) {
        Group gradient;
        for (int c = 0; c < kGroup; ++c) gradient[c] = out_gradient[static_cast<size_t>(c) * out_stride + static_cast<size_t>(begin + s)];
        if ((gradient == 0.0F).all()) continue;
        // Product rule.
        const Group to_plane = gradient * block.Line(table, s);
        const Group to_line = gradient * block.Plane(table, s);
        for (int k = 0; k < 4; ++k) add(block.plane[s][k], block.plane_weight[s][k], to_plane);
        for (int k = 0; k < 2; ++k) add(block.line[s] + k, block.line_weight[s][k], to_line);
      }
    }
  }
}

}  // namespace skyquilt::encoding
