#include "bench/study/pareto.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace skyquilt::bench {

std::vector<size_t> ParetoFront(const std::vector<Priced>& points) {
  std::vector<size_t> order;
  for (size_t i = 0; i < points.size(); ++i) {
    if (!std::isnan(points[i].cost) && !std::isnan(points[i].quality)) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    return points[a].cost < points[b].cost || (points[a].cost == points[b].cost && points[a].quality > points[b].quality);
  });
  std::vector<size_t> front;
  double best = -std::numeric_limits<double>::infinity();
  for (const size_t i : order) {
    if (points[i].quality <= best) continue;
    best = points[i].quality;
    front.push_back(i);
  }
  return front;
}

size_t BestForCost(const std::vector<Priced>& points, size_t point, double same_cost) {
  size_t best = point;
  for (size_t i = 0; i < points.size(); ++i) {
    if (points[i].cost <= (1.0 + same_cost) * points.at(point).cost && points[i].quality > points[best].quality) best = i;
  }
  return best;
}

}  // namespace skyquilt::bench
