// Connected pieces of cells between wall lines.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace skyquilt::buildings {

// Label of the piece of each inside cell ([v][u], counted from 0 in that order of first cells), -1 outside. Cells are connected by their sides.
// passes: whether one may go from cell (column, row) to the next along an axis (0: u, 1: v); empty: always.
std::vector<int> LabelPieces(const std::vector<uint8_t>& inside, int columns, int rows,
                             const std::function<bool(int column, int row, int axis)>& passes = {});

// Whether the cells are one piece and no two of them touch at a corner only.
bool IsOnePiece(const std::vector<uint8_t>& inside, int columns, int rows);

}  // namespace skyquilt::buildings
