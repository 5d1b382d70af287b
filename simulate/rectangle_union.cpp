#include "simulate/rectangle_union.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace skyquilt::simulate {
namespace {

constexpr double kSameLine_m = 1e-3;

// The different positions of sides, rising.
std::vector<double> LinesOf(std::vector<double> positions) {
  std::sort(positions.begin(), positions.end());
  std::vector<double> lines;
  for (const double position : positions) {
    if (lines.empty() || position - lines.back() > kSameLine_m) lines.push_back(position);
  }
  return lines;
}

int LineNear(const std::vector<double>& lines, double position) {
  return static_cast<int>(std::upper_bound(lines.begin(), lines.end(), position + 0.5 * kSameLine_m) - lines.begin()) - 1;
}

// Which cells between lines are covered; outside the grid none is.
class Cover {
 public:
  Cover(int columns, int rows) : columns_(columns), rows_(rows), covered_(static_cast<size_t>(columns) * static_cast<size_t>(rows), 0) {}
  bool At(int i, int j) const { return i >= 0 && j >= 0 && i < columns_ && j < rows_ && covered_[Index(i, j)] != 0; }
  void Set(int i, int j) { covered_[Index(i, j)] = 1; }

 private:
  size_t Index(int i, int j) const { return static_cast<size_t>(j) * static_cast<size_t>(columns_) + static_cast<size_t>(i); }
  int columns_, rows_;
  std::vector<uint8_t> covered_;
};

struct Step {
  int x, y;
};
constexpr std::array<Step, 4> kSteps = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};  // east, north, west, south: each is a left turn from the one before

// Whether a step from this crossing of lines has a covered cell on its left and none on its right.
bool IsBorder(const Cover& cover, int i, int j, size_t direction) {
  constexpr std::array<Step, 4> kLeft = {{{0, 0}, {-1, 0}, {-1, -1}, {0, -1}}};
  constexpr std::array<Step, 4> kRight = {{{0, -1}, {0, 0}, {-1, 0}, {-1, -1}}};
  return cover.At(i + kLeft[direction].x, j + kLeft[direction].y) && !cover.At(i + kRight[direction].x, j + kRight[direction].y);
}

}  // namespace

RectangleUnion UnionOf(std::span<const Rectangle2d> rectangles) {
  std::vector<double> all_x, all_y;
  for (const Rectangle2d& one : rectangles) {
    all_x.insert(all_x.end(), {one.min.x(), one.max.x()});
    all_y.insert(all_y.end(), {one.min.y(), one.max.y()});
  }
  const std::vector<double> x = LinesOf(std::move(all_x)), y = LinesOf(std::move(all_y));
  const auto columns = static_cast<int>(x.size()), rows = static_cast<int>(y.size());
  Cover cover(columns, rows);
  for (const Rectangle2d& one : rectangles) {
    for (int j = LineNear(y, one.min.y()); j < LineNear(y, one.max.y()); ++j) {
      for (int i = LineNear(x, one.min.x()); i < LineNear(x, one.max.x()); ++i) cover.Set(i, j);
    }
  }
  // From each border step not walked yet, along the border with the covered side on the left, until it closes.
  std::vector<uint8_t> walked(static_cast<size_t>(columns) * static_cast<size_t>(rows) * 4, 0);
  const auto Walked = [&](int i, int j, size_t direction) -> uint8_t& {
    return walked[(static_cast<size_t>(j) * static_cast<size_t>(columns) + static_cast<size_t>(i)) * 4 + direction];
  };
  RectangleUnion result;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      // Of the border of an area, its lowest stretch goes east on the outside and west in holes.
      for (const size_t first : {size_t{0}, size_t{2}}) {
        if (!IsBorder(cover, i, j, first) || Walked(i, j, first) != 0) continue;
        Ring ring;
        int at_x = i, at_y = j;
        size_t direction = first, before = 4;
        while (Walked(at_x, at_y, direction) == 0) {
          Walked(at_x, at_y, direction) = 1;
          if (direction != before) ring.emplace_back(x[static_cast<size_t>(at_x)], y[static_cast<size_t>(at_y)]);
          before = direction;
          at_x += kSteps[direction].x;
          at_y += kSteps[direction].y;
          // Where two areas touch at a corner, the left turn keeps them apart.
          for (const size_t turn : {1U, 0U, 3U}) {
            const size_t next = (before + turn) % 4;
            if (!IsBorder(cover, at_x, at_y, next)) continue;
            direction = next;
            break;
          }
        }
        if (direction == before) ring.erase(ring.begin());  // it began in the middle of a side
        if (SignedArea(ring) < 0.0) {
          result.holes.push_back(std::move(ring));
        } else if (SignedArea(ring) > SignedArea(result.outer)) {
          result.outer = std::move(ring);
        }
      }
    }
  }
  return result;
}

double SignedArea(const Ring& ring) {
  double twice = 0.0;
  for (size_t i = 0; i < ring.size(); ++i) {
    const Eigen::Vector2d& a = ring[i];
    const Eigen::Vector2d& b = ring[(i + 1) % ring.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

}  // namespace skyquilt::simulate
