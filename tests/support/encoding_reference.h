// Reference versions of all encodings, in double and one position at a time, to test the fast ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/encoding/frequency.h"
#include "core/encoding/hash_grid.h"
#include "core/encoding/plane_factors.h"
#include "core/encoding/voxel_grid.h"
#include "core/kernel/reference.h"

namespace skyquilt::testing {

// Weight of lattice point i at a position: 1 there, falling to 0 at its neighbours. Positions are clamped into the lattice, NaN counts as 0.
inline double Hat(double position, const kernel::GridLevel& lattice, int axis, int i) {
  const double scaled = position * static_cast<double>(lattice.cells_per_unit);
  const double inside = scaled > 0.0 ? std::min(scaled, lattice.size[axis] - 1.0) : 0.0;
  return std::max(0.0, 1.0 - std::abs(inside - i));
}

// table: `features` numbers for each point of a dense lattice, x fastest.
inline std::vector<double> LookUpLattice(const kernel::GridLevel& lattice, int features, const double* table, const double x[3]) {
  std::vector<double> out(static_cast<size_t>(features), 0.0);
  for (int k = 0; k < lattice.size[2]; ++k) {
    for (int j = 0; j < lattice.size[1]; ++j) {
      for (int i = 0; i < lattice.size[0]; ++i) {
        const double weight = Hat(x[0], lattice, 0, i) * Hat(x[1], lattice, 1, j) * Hat(x[2], lattice, 2, k);
        for (double& value : out) value += weight * *table++;
      }
    }
  }
  return out;
}

// axes: {plane's first, plane's second, line's}; table: plane entries, then line entries, of kGroup numbers.
inline std::vector<double> LookUpFactors(const kernel::GridLevel& lattice, const int axes[3], const double* table, const double x[3]) {
  constexpr size_t kGroup = encoding::PlaneFactors::kGroup;
  std::vector<double> plane(kGroup, 0.0), line(kGroup, 0.0), out;
  for (int j = 0; j < lattice.size[axes[1]]; ++j) {
    for (int i = 0; i < lattice.size[axes[0]]; ++i) {
      for (double& value : plane) value += Hat(x[axes[0]], lattice, axes[0], i) * Hat(x[axes[1]], lattice, axes[1], j) * *table++;
    }
  }
  for (int k = 0; k < lattice.size[axes[2]]; ++k) {
    for (double& value : line) value += Hat(x[axes[2]], lattice, axes[2], k) * *table++;
  }
  for (size_t c = 0; c < kGroup; ++c) out.push_back(plane[c] * line[c]);
  return out;
}

// All feature rows at x. config: the configuration of the encoding.
inline std::vector<double> EncodeInDouble(const encoding::Encoding& any, const encoding::HashGridConfig& config,
                                          const std::vector<double>& parameters, const double x[3]) {
  std::vector<double> rows;
  const auto append = [&](const std::vector<double>& more) { rows.insert(rows.end(), more.begin(), more.end()); };
  if (const auto* hash = dynamic_cast<const encoding::HashGrid*>(&any)) {
    for (int l = 0; l < hash->levels(); ++l) {
      const std::vector<double> table(parameters.begin() + any.Offset(l), parameters.begin() + any.Offset(l + 1));  // padding included
      append(kernel::reference::HashForward(hash->level(l), config.features, table, x));
    }
  } else if (const auto* voxels = dynamic_cast<const encoding::VoxelGrid*>(&any)) {
    for (int part = 0; part < any.parts(); ++part) append(LookUpLattice(voxels->lattice(), config.features, parameters.data() + any.Offset(part), x));
  } else if (const auto* planes = dynamic_cast<const encoding::PlaneFactors*>(&any)) {
    constexpr int kAxes[3][3] = {{1, 2, 0}, {0, 2, 1}, {0, 1, 2}};
    for (int part = 0; part < any.parts(); ++part) {
      append(LookUpFactors(planes->lattice(), kAxes[part * 3 / any.parts()], parameters.data() + any.Offset(part), x));
    }
  } else {
    double p[3];
    for (int axis = 0; axis < 3; ++axis)
      p[axis] = x[axis] > 0.0 ? std::min(x[axis], static_cast<double>(static_cast<float>(config.extent[axis]))) : 0.0;
    append({p[0], p[1], p[2], 1.0});
    for (int octave = 0; octave < any.parts() - 1; ++octave) {
      const double turn = 2.0 * M_PI * std::exp2(octave);
      append(
          {std::sin(turn * p[0]), std::sin(turn * p[1]), std::sin(turn * p[2]), std::cos(turn * p[0]), std::cos(turn * p[1]), std::cos(turn * p[2])});
    }
    rows.resize(static_cast<size_t>(any.OutputRows()), 0.0);
  }
  return rows;
}

}  // namespace skyquilt::testing
