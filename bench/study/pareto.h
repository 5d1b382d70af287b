// The Pareto front of training time and quality: the variants that no other variant beats in both.
#pragma once

#include <cstddef>
#include <vector>

namespace skyquilt::bench {

struct Priced {
  double cost = 0.0;     // smaller is better
  double quality = 0.0;  // larger is better
};

// Indices of the points for which no other point is at most as expensive and better, or cheaper and as good. In order of cost.
// Points with a NaN are left out.
std::vector<size_t> ParetoFront(const std::vector<Priced>& points);
// The point of the best quality at the cost of `point` or less; `point` itself where none is better.
// Points that cost up to the fraction same_cost (0 or more) more count as equally expensive, because measured times of equal budgets differ a little.
size_t BestForCost(const std::vector<Priced>& points, size_t point, double same_cost = 0.0);

}  // namespace skyquilt::bench
