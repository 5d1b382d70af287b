// Which cells of a field's box may hold matter. A cell keeps a decaying maximum of the optical depth of one marching step
// (Mueller et al. 2022, appendix E.2) and is occupied while that exceeds a threshold. Cells no camera sees stay empty for ever.
// Unit frame of the field; x fastest.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace skyquilt::field {

struct OccupancyGrid {
  // Per sample: some dozens of samples that find nothing free a cell, yet a surface that fills a tenth of a cell keeps it.
  static constexpr float kDecay = 0.9F;

  int size[3] = {0, 0, 0};        // cells per axis
  float cell = 1.0F;              // edge, unit lengths; the same on all axes
  std::vector<float> tau;         // decaying maximum per cell; negative: never seen, never sampled
  std::vector<uint8_t> occupied;  // 0 or 1 per cell

  // Covers [0, extent] with cells of about `wanted_cell`; everything occupied. At most max_cells cells (cells grow instead).
  static OccupancyGrid Make(const double extent[3], double wanted_cell, int64_t max_cells);
  int64_t CellCount() const { return static_cast<int64_t>(size[0]) * size[1] * size[2]; }
  int64_t Index(int x, int y, int z) const { return (static_cast<int64_t>(z) * size[1] + y) * size[0] + x; }
  // Cell of a position, clamped into the grid.
  int64_t IndexAt(float x, float y, float z) const;
  // A sample of the optical depth of one step at a position of a seen cell.
  void Observe(int64_t index, float step_tau) {
    float& cell_tau = tau[static_cast<size_t>(index)];
    if (cell_tau >= 0.0F) cell_tau = std::max(kDecay * cell_tau, step_tau);
  }
  // The six neighbours of every cell deeper than `solid` get at least `wake`, so that a surface can grow into them. Never seen ones do not.
  void WakeNeighbours(float solid, float wake);
  // Marks cells with tau above the threshold: min(limit, mean over seen cells). Returns the share occupied.
  double Refresh(float limit);
  // Cells whose tau is still exactly `start` were never sampled: nothing is known about them, so they count as never seen.
  void ForgetUnsampled(float start);
  double OccupiedShare() const;
  // Every cell within `cells` (max norm) of an occupied one becomes occupied, unless never seen.
  void Dilate(int cells);
};

}  // namespace skyquilt::field
