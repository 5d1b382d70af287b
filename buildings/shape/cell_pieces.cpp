#include "buildings/shape/cell_pieces.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace skyquilt::buildings {

std::vector<int> LabelPieces(const std::vector<uint8_t>& inside, int columns, int rows,
                             const std::function<bool(int column, int row, int axis)>& passes) {
  const auto index = [&](int c, int r) { return static_cast<size_t>(r) * static_cast<size_t>(columns) + static_cast<size_t>(c); };
  std::vector<int> label(inside.size(), -1);
  std::vector<std::pair<int, int>> stack;
  int count = 0;
  const auto visit = [&](int c, int r) {
    if (inside[index(c, r)] == 0 || label[index(c, r)] >= 0) return false;
    label[index(c, r)] = count;
    stack.emplace_back(c, r);
    return true;
  };
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (!visit(column, row)) continue;
      while (!stack.empty()) {
        const auto [c, r] = stack.back();
        stack.pop_back();
        if (c + 1 < columns && (!passes || passes(c, r, 0))) visit(c + 1, r);
        if (c > 0 && (!passes || passes(c - 1, r, 0))) visit(c - 1, r);
        if (r + 1 < rows && (!passes || passes(c, r, 1))) visit(c, r + 1);
        if (r > 0 && (!passes || passes(c, r - 1, 1))) visit(c, r - 1);
      }
      ++count;
    }
  }
  return label;
}

bool IsOnePiece(const std::vector<uint8_t>& inside, int columns, int rows) {
  const auto at = [&](int c, int r) { return inside[static_cast<size_t>(r) * static_cast<size_t>(columns) + static_cast<size_t>(c)] != 0; };
  for (int r = 0; r + 1 < rows; ++r) {
    for (int c = 0; c + 1 < columns; ++c) {
      if (at(c, r) == at(c + 1, r + 1) && at(c + 1, r) == at(c, r + 1) && at(c, r) != at(c + 1, r)) return false;
    }
  }
  const std::vector<int> label = LabelPieces(inside, columns, rows);
  return !label.empty() && *std::max_element(label.begin(), label.end()) == 0;
}

}  // namespace skyquilt::buildings
