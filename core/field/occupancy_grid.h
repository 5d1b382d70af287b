// Marks the cells of a field's box that may contain something, so that samples in free space are skipped. Each cell keeps a decaying maximum of the
// optical depth of one marching step (Mueller et al. 2022, appendix E.2) and is occupied while that is above a threshold. Cells that no camera sees
// are never occupied. Unit frame of the field; x fastest.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace skyquilt::field {

struct OccupancyGrid {
  // Decay per sample: a few dozen empty samples free a cell, but one sample in ten on a thin surface keeps it occupied.
  static constexpr float kDecay = 0.9F;

  int size[3] = {0, 0, 0};      // cells per axis
  float cell = 1.0F;            // edge of a cell, unit lengths; the same on all axes
  std::vector<float> tau;       // per cell: decaying maximum of the optical depth of a step; negative: no camera sees the cell
  std::vector<bool> occupied;   // per cell; one bit each, so that what rays look up at random stays in cache
  std::vector<uint8_t> judged;  // 0 or 1 per cell: whether a sample was in it that is not wider than the cell; empty in scenes

  // Covers [0, extent] with cells of edge `wanted_cell`, or larger so that there are at most max_cells; all cells occupied.
  static OccupancyGrid Make(const double extent[3], double wanted_cell, int64_t max_cells);
  int64_t CellCount() const { return static_cast<int64_t>(size[0]) * size[1] * size[2]; }
  int64_t Index(int x, int y, int z) const { return (static_cast<int64_t>(z) * size[1] + y) * size[0] + x; }
  // Cell of a position, clamped into the grid.
  int64_t IndexAt(float x, float y, float z) const;
  // Updates the decaying maximum of a cell with the optical depth of one step in it; cells never seen do not change.
  void UpdateTau(int64_t index, float step_tau) {
    float& cell_tau = tau[static_cast<size_t>(index)];
    if (cell_tau >= 0.0F) cell_tau = std::max(kDecay * cell_tau, step_tau);
  }
  // The same for a sample that trained the field. sharp: it is not wider than the cell. A wider one stands for several cells and counts only where no
  // sharp one has been, so that a cell that only wide pixels see is freed by evidence too, and never for lack of it.
  void Observe(int64_t index, float step_tau, bool sharp) {
    uint8_t& known = judged[static_cast<size_t>(index)];
    if (!sharp && known != 0) return;
    if (sharp) known = 1;
    UpdateTau(index, step_tau);
  }
  // Raises tau of the six neighbours of every cell with tau > solid to at least `wake`, so that a surface can grow into them. Cells never seen stay.
  void RaiseNeighbours(float solid, float wake);
  // Sets `occupied` where tau is above min(limit, mean over seen cells).
  void UpdateOccupied(float limit);
  // Treats cells whose tau still has its initial value `start` as never seen: no sample was in them, so nothing was learned there.
  void MarkUnsampled(float start);
  // Share of all cells that are occupied, 0 to 1.
  double OccupiedShare() const;
  // Occupies every cell within `cells` (max norm) of an occupied one, unless it was never seen.
  void Dilate(int cells);
};

}  // namespace skyquilt::field
