#include "surface/maps/window_filter.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "surface/maps/height_raster.h"

namespace skyquilt::surface {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kColumnsAtOnce = 16;  // so that columns are read in whole cache lines

// Minimum of sliding windows over one line: with the line cut into pieces as long as a window, each window is the end of one piece and the beginning
// of the next.
class LineMinimum {
 public:
  LineMinimum(int length, int half) : length_(length), window_(2 * half + 1) {
    const int padded = length + 2 * half;
    line_.assign(static_cast<size_t>(padded), kInfinity);
    from_start_.resize(line_.size());
    to_end_.resize(line_.size());
    first_ = static_cast<size_t>(half);
  }
  float& Input(int i) { return line_[first_ + static_cast<size_t>(i)]; }
  float Result(int i) const {
    const auto begin = static_cast<size_t>(i);
    return std::min(to_end_[begin], from_start_[begin + static_cast<size_t>(window_) - 1]);
  }
  void Run() {
    const size_t n = line_.size();
    const auto window = static_cast<size_t>(window_);
    for (size_t begin = 0; begin < n; begin += window) {
      const size_t end = std::min(begin + window, n);
      from_start_[begin] = line_[begin];
      for (size_t i = begin + 1; i < end; ++i) from_start_[i] = std::min(from_start_[i - 1], line_[i]);
      to_end_[end - 1] = line_[end - 1];
      for (size_t i = end - 1; i > begin; --i) to_end_[i - 1] = std::min(to_end_[i], line_[i - 1]);
    }
  }
  int length() const { return length_; }

 private:
  int length_, window_;
  size_t first_ = 0;
  std::vector<float> line_, from_start_, to_end_;
};

void MinimumAlongRows(base::Grid<float>* grid, int half) {
  LineMinimum line(grid->columns, half);
  for (int row = 0; row < grid->rows; ++row) {
    float* values = grid->value.data() + grid->Index(0, row);
    for (int i = 0; i < line.length(); ++i) line.Input(i) = values[i];
    line.Run();
    for (int i = 0; i < line.length(); ++i) values[i] = line.Result(i);
  }
}

void MinimumAlongColumns(base::Grid<float>* grid, int half) {
  std::vector<LineMinimum> lines(kColumnsAtOnce, LineMinimum(grid->rows, half));
  for (int first = 0; first < grid->columns; first += kColumnsAtOnce) {
    const int n = std::min(kColumnsAtOnce, grid->columns - first);
    for (int row = 0; row < grid->rows; ++row) {
      for (int i = 0; i < n; ++i) lines[static_cast<size_t>(i)].Input(row) = grid->At(first + i, row);
    }
    for (int i = 0; i < n; ++i) lines[static_cast<size_t>(i)].Run();
    for (int row = 0; row < grid->rows; ++row) {
      for (int i = 0; i < n; ++i) grid->value[grid->Index(first + i, row)] = lines[static_cast<size_t>(i)].Result(row);
    }
  }
}

// sign 1: minimum, -1: maximum.
base::Grid<float> Extreme(const base::Grid<float>& grid, int half, float sign) {
  base::Grid<float> result = grid;
  if (grid.value.empty()) return result;
  for (float& value : result.value) value = std::isnan(value) ? kInfinity : sign * value;
  // A window that is larger than the grid on all sides sees no more.
  MinimumAlongRows(&result, std::clamp(half, 0, grid.columns));
  MinimumAlongColumns(&result, std::clamp(half, 0, grid.rows));
  for (float& value : result.value) value = value == kInfinity ? kNoHeight : sign * value;
  return result;
}

void KeepGaps(const base::Grid<float>& of, base::Grid<float>* in) {
  for (size_t i = 0; i < of.value.size(); ++i) {
    if (std::isnan(of.value[i])) in->value[i] = kNoHeight;
  }
}

base::Grid<float> TwoSteps(const base::Grid<float>& grid, int half, float sign) {
  base::Grid<float> first = Extreme(grid, half, sign);
  KeepGaps(grid, &first);
  base::Grid<float> second = Extreme(first, half, -sign);
  KeepGaps(grid, &second);
  return second;
}

}  // namespace

base::Grid<float> WindowMinimum(const base::Grid<float>& grid, int half) {
  return Extreme(grid, half, 1.0F);
}

base::Grid<float> WindowMaximum(const base::Grid<float>& grid, int half) {
  return Extreme(grid, half, -1.0F);
}

base::Grid<float> Opening(const base::Grid<float>& grid, int half) {
  return TwoSteps(grid, half, 1.0F);
}

base::Grid<float> Closing(const base::Grid<float>& grid, int half) {
  return TwoSteps(grid, half, -1.0F);
}

}  // namespace skyquilt::surface
