// The least cut of a graph: each node is inside or outside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace skyquilt::buildings {

class GraphCut {
 public:
  explicit GraphCut(size_t nodes) : inside_(nodes, 0.0), outside_(nodes, 0.0) {}

  // What it costs to have the node inside or outside, not negative; adds to earlier costs.
  void AddNode(size_t node, double inside_cost, double outside_cost);
  // What it costs when one of the two is inside and the other not, not negative.
  void AddPair(size_t a, size_t b, double cost);
  // 1: inside. Nodes that may be either are outside. Costs are rounded to 1e-6 of the largest, so that rounding cannot keep the solver busy.
  // boykov_kolmogorov_max_flow of Boost.Graph (Boykov and Kolmogorov 2004).
  std::vector<uint8_t> Solve() const;

 private:
  struct Pair {
    size_t a, b;
    double cost;
  };
  std::vector<double> inside_, outside_;
  std::vector<Pair> pairs_;
};

}  // namespace skyquilt::buildings
