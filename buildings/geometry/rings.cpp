#include "buildings/geometry/rings.h"

#include <algorithm>
#include <unordered_map>

namespace skyquilt::buildings {

double SignedArea(std::span<const Eigen::Vector2d> ring) {
  double twice = 0.0;
  for (size_t i = 1; i + 1 < ring.size(); ++i) twice += Cross2(ring[i] - ring[0], ring[i + 1] - ring[0]);
  return 0.5 * twice;
}

bool RingContains(std::span<const Eigen::Vector2d> ring, const Eigen::Vector2d& point) {
  bool inside = false;
  for (size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
    const Eigen::Vector2d &a = ring[i], &b = ring[j];
    if ((a.y() > point.y()) == (b.y() > point.y())) continue;
    if (point.x() < a.x() + (b.x() - a.x()) * (point.y() - a.y()) / (b.y() - a.y())) inside = !inside;
  }
  return inside;
}

double DistanceToSegment(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d ab = b - a;
  const double length2 = ab.squaredNorm();
  const double along = length2 > 0.0 ? std::clamp((point - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (point - a - along * ab).norm();
}

std::vector<std::vector<uint32_t>> SplitAtRepeats(std::span<const uint32_t> ring) {
  std::vector<std::vector<uint32_t>> rings;
  std::vector<uint32_t> open;
  std::unordered_map<uint32_t, size_t> place;  // in `open`
  const auto close = [&](size_t from) {
    if (open.size() - from >= 3) rings.emplace_back(open.begin() + static_cast<std::ptrdiff_t>(from), open.end());
    for (size_t i = from; i < open.size(); ++i) place.erase(open[i]);
    open.resize(from);
  };
  for (const uint32_t v : ring) {
    if (const auto seen = place.find(v); seen != place.end()) close(seen->second);
    place.emplace(v, open.size());
    open.push_back(v);
  }
  close(0);
  return rings;
}

}  // namespace skyquilt::buildings
