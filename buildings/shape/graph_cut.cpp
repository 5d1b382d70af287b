#include "buildings/shape/graph_cut.h"

#include <algorithm>
#include <cmath>

// gcc 12 believes that Boost reads what it has not set.
#pragma GCC diagnostic push
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#pragma GCC diagnostic ignored "-Wnull-dereference"
#endif
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>

namespace skyquilt::buildings {
namespace {

constexpr double kUnits = 1e6;  // of the largest cost

using Traits = boost::adjacency_list_traits<boost::vecS, boost::vecS, boost::directedS>;
using NodeProperties = boost::property<
    boost::vertex_index_t, size_t,
    boost::property<boost::vertex_color_t, boost::default_color_type,
                    boost::property<boost::vertex_distance_t, int64_t, boost::property<boost::vertex_predecessor_t, Traits::edge_descriptor>>>>;
using EdgeProperties =
    boost::property<boost::edge_capacity_t, int64_t,
                    boost::property<boost::edge_residual_capacity_t, int64_t, boost::property<boost::edge_reverse_t, Traits::edge_descriptor>>>;
using Graph = boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS, NodeProperties, EdgeProperties>;

void Connect(Graph* graph, size_t a, size_t b, int64_t forward, int64_t backward) {
  const auto there = boost::add_edge(a, b, *graph).first, back = boost::add_edge(b, a, *graph).first;
  boost::put(boost::edge_capacity, *graph, there, forward);
  boost::put(boost::edge_capacity, *graph, back, backward);
  boost::put(boost::edge_reverse, *graph, there, back);
  boost::put(boost::edge_reverse, *graph, back, there);
}

}  // namespace

void GraphCut::AddNode(size_t node, double inside_cost, double outside_cost) {
  inside_[node] += inside_cost;
  outside_[node] += outside_cost;
}

void GraphCut::AddPair(size_t a, size_t b, double cost) {
  pairs_.push_back({a, b, cost});
}

std::vector<uint8_t> GraphCut::Solve() const {
  const size_t n = inside_.size(), source = n, sink = n + 1;
  double largest = 0.0;
  for (size_t i = 0; i < n; ++i) largest = std::max({largest, inside_[i], outside_[i]});
  for (const Pair& pair : pairs_) largest = std::max(largest, pair.cost);
  std::vector<uint8_t> inside(n, 0);
  if (!(largest > 0.0)) return inside;
  const auto units = [&](double cost) { return static_cast<int64_t>(std::llround(kUnits * std::max(0.0, cost) / largest)); };
  Graph graph(n + 2);
  for (size_t i = 0; i < n; ++i) {
    Connect(&graph, source, i, units(outside_[i]), 0);
    Connect(&graph, i, sink, units(inside_[i]), 0);
  }
  for (const Pair& pair : pairs_) Connect(&graph, pair.a, pair.b, units(pair.cost), units(pair.cost));
  boost::boykov_kolmogorov_max_flow(graph, source, sink);
  for (size_t i = 0; i < n; ++i) inside[i] = boost::get(boost::vertex_color, graph, i) == boost::get(boost::vertex_color, graph, source) ? 1 : 0;
  return inside;
}

}  // namespace skyquilt::buildings
#pragma GCC diagnostic pop
