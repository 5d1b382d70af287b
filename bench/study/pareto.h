// Which of several ways to pay for quality are worth their price.
#pragma once

#include <cstddef>
#include <vector>

namespace skyquilt::bench {

struct Priced {
  double cost = 0.0;     // smaller is better
  double quality = 0.0;  // larger is better
};

// Indices of the points that no other point beats: none is at most as dear and better, or cheaper and as good. In order of cost.
// Points with a NaN are left out.
std::vector<size_t> ParetoFront(const std::vector<Priced>& points);
// How far a point lies under the front: the quality that the front offers at its cost or less, minus its own; 0 on the front.
// Costs up to `same_cost` (a share, 0 or more) higher count as its own: measured times of equal budgets differ a little.
double BelowFront(const std::vector<Priced>& points, size_t point, double same_cost = 0.0);

}  // namespace skyquilt::bench
