#include <algorithm>
#include <numeric>

#include "surface/mesh/hole_patch.h"
#include "surface/mesh/vectors.h"

namespace skyquilt::surface {
namespace {

// Whether the segments have a point in common.
bool Meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c, const Eigen::Vector2d& d) {
  const auto within = [](double p, double q, double r, double s) {
    return std::max(std::min(p, q), std::min(r, s)) <= std::min(std::max(p, q), std::max(r, s));
  };
  if (!within(a.x(), b.x(), c.x(), d.x()) || !within(a.y(), b.y(), c.y(), d.y())) return false;
  const double abc = DoubleAreaFromAbove(a, b, c), abd = DoubleAreaFromAbove(a, b, d);
  const double cda = DoubleAreaFromAbove(c, d, a), cdb = DoubleAreaFromAbove(c, d, b);
  // On opposite sides or on the line; products could underflow.
  const auto apart = [](double s, double t) { return (s <= 0.0 && t >= 0.0) || (s >= 0.0 && t <= 0.0); };
  return apart(abc, abd) && apart(cda, cdb);
}

}  // namespace

bool CrossesItself(std::span<const Eigen::Vector3d> border) {
  const size_t n = border.size();
  const auto at = [&](size_t i) -> Eigen::Vector2d { return border[i % n].head<2>(); };
  for (size_t i = 0; i < n; ++i) {
    // Neighbours share a vertex; they cross only when one folds back onto the other.
    const Eigen::Vector2d back = at(i) - at(i + 1), ahead = at(i + 2) - at(i + 1);
    if (DoubleAreaFromAbove(at(i), at(i + 1), at(i + 2)) == 0.0 && back.dot(ahead) >= 0.0) return true;
    for (size_t j = i + 2; j < n; ++j) {
      if (i == 0 && j == n - 1) continue;
      if (Meet(at(i), at(i + 1), at(j), at(j + 1))) return true;
    }
  }
  return false;
}

std::optional<std::vector<Triangle>> CutEars(std::span<const Eigen::Vector3d> border) {
  const size_t n = border.size();
  if (n < 3) return std::nullopt;
  std::vector<size_t> next(n), previous(n);
  std::iota(next.begin(), next.end(), size_t{1});
  next.back() = 0;
  for (size_t i = 0; i < n; ++i) previous[next[i]] = i;
  const auto at = [&](size_t i) -> Eigen::Vector2d { return border[i].head<2>(); };
  const auto is_ear = [&](size_t tip) {
    const Eigen::Vector2d a = at(previous[tip]), b = at(tip), c = at(next[tip]);
    if (!(DoubleAreaFromAbove(a, b, c) > 0.0)) return false;
    for (size_t i = next[next[tip]]; i != previous[tip]; i = next[i]) {
      const Eigen::Vector2d x = at(i);
      if (DoubleAreaFromAbove(a, b, x) >= 0.0 && DoubleAreaFromAbove(b, c, x) >= 0.0 && DoubleAreaFromAbove(c, a, x) >= 0.0) return false;
    }
    return true;
  };
  std::vector<Triangle> triangles;
  triangles.reserve(n - 2);
  size_t left = n, tip = 0, failed = 0;
  while (left >= 3 && failed < left) {
    if (!is_ear(tip)) {
      ++failed;
      tip = next[tip];
      continue;
    }
    triangles.push_back({static_cast<uint32_t>(previous[tip]), static_cast<uint32_t>(tip), static_cast<uint32_t>(next[tip])});
    next[previous[tip]] = next[tip];
    previous[next[tip]] = previous[tip];
    --left;
    failed = 0;
    if (left == 2) return triangles;
    tip = next[next[tip]];  // not beside the last ear, which would make a fan of slivers
  }
  return std::nullopt;
}

}  // namespace skyquilt::surface
