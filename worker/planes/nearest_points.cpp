#include "worker/planes/nearest_points.h"

#include <algorithm>
#include <limits>

namespace skyquilt::worker {

using Eigen::Vector3d;

struct NearestPoints::Search {
  Vector3d x;
  std::span<int32_t> nearest;
  std::vector<double> squares;  // of the distances of `nearest`
  size_t found = 0;

  double Farthest() const { return found < nearest.size() ? std::numeric_limits<double>::infinity() : squares[found - 1]; }
  void Offer(const Node& node) {
    const double square = (node.x - x).squaredNorm();
    if (!(square < Farthest())) return;
    size_t i = found < nearest.size() ? found++ : found - 1;
    for (; i > 0 && squares[i - 1] > square; --i) {
      squares[i] = squares[i - 1];
      nearest[i] = nearest[i - 1];
    }
    squares[i] = square;
    nearest[i] = node.index;
  }
};

NearestPoints::NearestPoints(const std::vector<Vector3d>& points) {
  nodes_.reserve(points.size());
  for (const Vector3d& x : points) nodes_.push_back({x, static_cast<int32_t>(nodes_.size()), 0});
  Build(0, nodes_.size());
}

void NearestPoints::Build(size_t begin, size_t end) {
  if (end - begin < 2) return;
  Vector3d low = nodes_[begin].x, high = low;
  for (size_t i = begin + 1; i < end; ++i) {
    low = low.cwiseMin(nodes_[i].x);
    high = high.cwiseMax(nodes_[i].x);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const auto at = [this](size_t i) { return nodes_.begin() + static_cast<std::ptrdiff_t>(i); };
  const size_t middle = begin + (end - begin) / 2;
  // Indices part points of equal coordinates, so that the tree depends on nothing but the points.
  std::nth_element(at(begin), at(middle), at(end),
                   [axis](const Node& a, const Node& b) { return a.x[axis] < b.x[axis] || (a.x[axis] == b.x[axis] && a.index < b.index); });
  nodes_[middle].axis = axis;
  Build(begin, middle);
  Build(middle + 1, end);
}

size_t NearestPoints::Find(const Vector3d& x, std::span<int32_t> nearest) const {
  Search search{x, nearest, std::vector<double>(nearest.size()), 0};
  if (!nearest.empty()) Visit(0, nodes_.size(), search);
  return search.found;
}

void NearestPoints::Visit(size_t begin, size_t end, Search& search) const {
  if (begin == end) return;
  const size_t middle = begin + (end - begin) / 2;
  const Node& node = nodes_[middle];
  search.Offer(node);
  const double beyond = search.x[node.axis] - node.x[node.axis];
  if (beyond < 0.0) {
    Visit(begin, middle, search);
    if (beyond * beyond < search.Farthest()) Visit(middle + 1, end, search);
  } else {
    Visit(middle + 1, end, search);
    if (beyond * beyond < search.Farthest()) Visit(begin, middle, search);
  }
}

}  // namespace skyquilt::worker
