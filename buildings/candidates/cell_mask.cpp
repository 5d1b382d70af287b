#include "buildings/candidates/cell_mask.h"

#include <algorithm>
#include <array>

namespace skyquilt::buildings {
namespace {

// Carries nearest cells from neighbours to their neighbours.
class NearestMap {
 public:
  explicit NearestMap(const CellMask& mask) : mask_(mask), nearest_(mask.value.size(), -1) {
    for (size_t i = 0; i < mask.value.size(); ++i) {
      if (mask.value[i] != 0) nearest_[i] = static_cast<int32_t>(i);
    }
  }
  std::vector<int32_t> Find() && {
    for (int row = 0; row < mask_.rows; ++row) {
      for (int column = 0; column < mask_.columns; ++column) TakeFrom(column, row, {{{-1, 0}, {-1, -1}, {0, -1}, {1, -1}}});
      for (int column = mask_.columns - 1; column >= 0; --column) TakeFrom(column, row, {{{1, 0}, {1, -1}, {0, -1}, {-1, -1}}});
    }
    for (int row = mask_.rows - 1; row >= 0; --row) {
      for (int column = mask_.columns - 1; column >= 0; --column) TakeFrom(column, row, {{{1, 0}, {1, 1}, {0, 1}, {-1, 1}}});
      for (int column = 0; column < mask_.columns; ++column) TakeFrom(column, row, {{{-1, 0}, {-1, 1}, {0, 1}, {1, 1}}});
    }
    return std::move(nearest_);
  }

 private:
  void TakeFrom(int column, int row, const std::array<std::array<int, 2>, 4>& steps) {
    const size_t here = mask_.Index(column, row);
    double least = CellDistance(mask_, here, nearest_[here]);
    for (const auto& [dx, dy] : steps) {
      if (!mask_.Inside(column + dx, row + dy)) continue;
      const int32_t offered = nearest_[mask_.Index(column + dx, row + dy)];
      const double distance = CellDistance(mask_, here, offered);
      if (distance < least) {
        least = distance;
        nearest_[here] = offered;
      }
    }
  }

  const CellMask& mask_;
  std::vector<int32_t> nearest_;
};

}  // namespace

std::vector<int32_t> NearestCells(const CellMask& mask) {
  return NearestMap(mask).Find();
}

CellMask Dilated(const CellMask& mask, double radius) {
  const std::vector<int32_t> nearest = NearestCells(mask);
  CellMask result(mask.columns, mask.rows);
  for (size_t i = 0; i < nearest.size(); ++i) result.value[i] = CellDistance(mask, i, nearest[i]) <= radius ? 1 : 0;
  return result;
}

CellMask Eroded(const CellMask& mask, double radius) {
  CellMask outside(mask.columns, mask.rows);
  for (size_t i = 0; i < mask.value.size(); ++i) outside.value[i] = mask.value[i] == 0 ? 1 : 0;
  const std::vector<int32_t> nearest = NearestCells(outside);
  CellMask result(mask.columns, mask.rows);
  for (int row = 0; row < mask.rows; ++row) {
    for (int column = 0; column < mask.columns; ++column) {
      const size_t i = mask.Index(column, row);
      const int border = std::min({column + 1, row + 1, mask.columns - column, mask.rows - row});
      result.value[i] = CellDistance(mask, i, nearest[i]) > radius && border > radius ? 1 : 0;
    }
  }
  return result;
}

CellMask Opened(const CellMask& mask, double radius) {
  CellMask opened = Dilated(Eroded(mask, radius), radius);
  for (size_t i = 0; i < mask.value.size(); ++i) opened.value[i] = opened.value[i] != 0 && mask.value[i] != 0 ? 1 : 0;
  return opened;
}

std::vector<std::vector<uint32_t>> ConnectedParts(const CellMask& mask) {
  std::vector<std::vector<uint32_t>> parts;
  std::vector<uint8_t> seen(mask.value.size(), 0);
  for (uint32_t start = 0; start < mask.value.size(); ++start) {
    if (mask.value[start] == 0 || seen[start] != 0) continue;
    std::vector<uint32_t>& part = parts.emplace_back(1, start);
    seen[start] = 1;
    for (size_t i = 0; i < part.size(); ++i) {
      const auto column = static_cast<int>(part[i] % static_cast<uint32_t>(mask.columns));
      const auto row = static_cast<int>(part[i] / static_cast<uint32_t>(mask.columns));
      for (const auto& [dx, dy] : {std::array{-1, 0}, std::array{1, 0}, std::array{0, -1}, std::array{0, 1}}) {
        if (!mask.Inside(column + dx, row + dy)) continue;
        const size_t next = mask.Index(column + dx, row + dy);
        if (mask.value[next] == 0 || seen[next] != 0) continue;
        seen[next] = 1;
        part.push_back(static_cast<uint32_t>(next));
      }
    }
    std::sort(part.begin(), part.end());
  }
  return parts;
}

}  // namespace skyquilt::buildings
