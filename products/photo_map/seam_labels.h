// Which photo paints which part of a map: each node of a lattice takes one of its candidates, cheap ones, and photos change where they agree.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace skyquilt::products {

// Arrays are [row][column][candidate], rgb with three colours after that.
struct LabelLattice {
  int columns = 0;
  int rows = 0;
  int candidates = 0;          // places per node, 1 to 8
  std::vector<int32_t> label;  // number of the photo, each once per node, or -1: no more candidates
  std::vector<float> cost;     // of each candidate, >= 0; not looked at without one
  std::vector<float> rgb;      // what the photo shows at the node, display values in 0..1 in one common light
};

// Sum of the chosen candidates' costs, and smoothness times the sum of the seam costs over all pairs of neighbours (4 per node). Between neighbours a
// and b with photos p and q the seam costs nothing when p = q, else
//   0.02 + |I_p(a) - I_q(a)| + |I_p(b) - I_q(b)|     (mean over the colours)
// and a difference counts 0.25 where one of the two photos is no candidate of that node. A pair costs nothing when one of them has no candidate.
// chosen: candidate of each node, row-major, or -1 for nodes without one. Throws std::logic_error for arrays of wrong sizes.
double LabelEnergy(const LabelLattice& lattice, std::span<const int8_t> chosen, float smoothness);

// A choice of low energy, never above that of the cheapest candidate everywhere; -1 for nodes without candidates. Min-sum loopy belief propagation
// (Felzenszwalb and Huttenlocher 2006, section 3.2: nodes of a checkerboard's two colours send in turn, `rounds` times each), then improvements of
// single nodes (iterated conditional modes, Besag 1986) of its result and of the cheapest choice, of which the better one is taken. The result does
// not depend on chance. Time: some microseconds per node; memory: 16 bytes per candidate. Throws std::logic_error for arrays of wrong sizes.
std::vector<int8_t> ChooseLabels(const LabelLattice& lattice, float smoothness, int rounds = 12);

}  // namespace skyquilt::products
