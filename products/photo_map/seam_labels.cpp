#include "products/photo_map/seam_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/base/errors.h"

namespace skyquilt::products {
namespace {

constexpr int kMostCandidates = 8;
constexpr float kSeamItself = 0.02F;
constexpr float kUnknownDifference = 0.25F;
constexpr int kMostSweeps = 10;

struct LabelNode {
  const int32_t* label;
  const float* cost;
  const float* rgb;
  int count;  // of candidates
};

LabelNode NodeOf(const LabelLattice& lattice, size_t node) {
  const size_t first = node * static_cast<size_t>(lattice.candidates);
  LabelNode view{lattice.label.data() + first, lattice.cost.data() + first, lattice.rgb.data() + 3 * first, 0};
  while (view.count < lattice.candidates && view.label[view.count] >= 0) ++view.count;
  return view;
}

size_t NodesOf(const LabelLattice& lattice) {
  return static_cast<size_t>(lattice.columns) * static_cast<size_t>(lattice.rows);
}

void CheckLattice(const LabelLattice& lattice) {
  SKYQUILT_CHECK(lattice.columns >= 0 && lattice.rows >= 0 && lattice.candidates >= 1 && lattice.candidates <= kMostCandidates,
                 "a label lattice has 1 to 8 candidates per node");
  const size_t candidates = NodesOf(lattice) * static_cast<size_t>(lattice.candidates);
  SKYQUILT_CHECK(lattice.label.size() == candidates && lattice.cost.size() == candidates && lattice.rgb.size() == 3 * candidates,
                 "arrays of a label lattice do not match its size");
}

// Directions: 0 left, 1 right, 2 above, 3 below; the opposite one is direction ^ 1.
template <typename Function>
void ForNeighbours(const LabelLattice& lattice, size_t node, const Function& function) {
  const size_t columns = static_cast<size_t>(lattice.columns);
  const size_t column = node % columns;
  if (column > 0) function(0, node - 1);
  if (column + 1 < columns) function(1, node + 1);
  if (node >= columns) function(2, node - columns);
  if (node + columns < NodesOf(lattice)) function(3, node + columns);
}

float ColorDifference(const LabelNode& node, int i, int j) {
  const float* a = node.rgb + static_cast<ptrdiff_t>(3) * i;
  const float* b = node.rgb + static_cast<ptrdiff_t>(3) * j;
  return (std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2])) / 3.0F;
}

// The candidate of a node with this label, -1: none.
int CandidateOf(const LabelNode& node, int32_t label) {
  for (int i = 0; i < node.count; ++i) {
    if (node.label[i] == label) return i;
  }
  return -1;
}

float SeamCost(const LabelNode& a, int i, const LabelNode& b, int j) {
  if (a.label[i] == b.label[j]) return 0.0F;
  const int j_at_a = CandidateOf(a, b.label[j]);
  const int i_at_b = CandidateOf(b, a.label[i]);
  return kSeamItself + (j_at_a >= 0 ? ColorDifference(a, i, j_at_a) : kUnknownDifference) +
         (i_at_b >= 0 ? ColorDifference(b, i_at_b, j) : kUnknownDifference);
}

using CandidatePairs = std::array<std::array<float, kMostCandidates>, kMostCandidates>;

void FillDifferences(const LabelNode& node, CandidatePairs* differences) {
  for (int i = 0; i < node.count; ++i) {
    (*differences)[static_cast<size_t>(i)][static_cast<size_t>(i)] = 0.0F;
    for (int j = 0; j < i; ++j) {
      const float difference = ColorDifference(node, i, j);
      (*differences)[static_cast<size_t>(i)][static_cast<size_t>(j)] = difference;
      (*differences)[static_cast<size_t>(j)][static_cast<size_t>(i)] = difference;
    }
  }
}

class Messages {
 public:
  Messages(const LabelLattice& lattice, float smoothness)
      : lattice_(lattice), smoothness_(smoothness), incoming_(NodesOf(lattice) * 4 * static_cast<size_t>(lattice.candidates), 0.0F) {}

  // What the candidates of a node cost with all that its neighbours have sent.
  std::array<float, kMostCandidates> Sums(size_t node, const LabelNode& view) const {
    std::array<float, kMostCandidates> sums{};
    for (int i = 0; i < view.count; ++i) sums[static_cast<size_t>(i)] = view.cost[i];
    for (int direction = 0; direction < 4; ++direction) {
      const float* const message = incoming_.data() + Place(node, direction);
      for (int i = 0; i < view.count; ++i) sums[static_cast<size_t>(i)] += message[i];
    }
    return sums;
  }

  void Send(size_t node) {
    const LabelNode from = NodeOf(lattice_, node);
    if (from.count == 0) return;
    const std::array<float, kMostCandidates> sums = Sums(node, from);
    CandidatePairs at_from{};
    FillDifferences(from, &at_from);
    ForNeighbours(lattice_, node, [&](int direction, size_t neighbour) {
      const LabelNode to = NodeOf(lattice_, neighbour);
      if (to.count == 0) return;
      CandidatePairs at_to{};
      FillDifferences(to, &at_to);
      std::array<int, kMostCandidates> from_at_to{};
      for (int i = 0; i < from.count; ++i) from_at_to[static_cast<size_t>(i)] = CandidateOf(to, from.label[i]);
      const float* const received = incoming_.data() + Place(node, direction);
      float* const sent = incoming_.data() + Place(neighbour, direction ^ 1);
      for (int j = 0; j < to.count; ++j) {
        const int to_at_from = CandidateOf(from, to.label[j]);
        float best = 0.0F;
        for (int i = 0; i < from.count; ++i) {
          float seam = 0.0F;
          if (i != to_at_from) {
            const int i_at_to = from_at_to[static_cast<size_t>(i)];
            seam = kSeamItself + (to_at_from >= 0 ? at_from[static_cast<size_t>(i)][static_cast<size_t>(to_at_from)] : kUnknownDifference) +
                   (i_at_to >= 0 ? at_to[static_cast<size_t>(i_at_to)][static_cast<size_t>(j)] : kUnknownDifference);
          }
          const float sum = sums[static_cast<size_t>(i)] - received[i] + smoothness_ * seam;
          if (i == 0 || sum < best) best = sum;
        }
        sent[j] = best;
      }
      const float least = *std::min_element(sent, sent + to.count);
      for (int j = 0; j < to.count; ++j) sent[j] -= least;  // only differences count, and sums do not grow from round to round
    });
  }

 private:
  size_t Place(size_t node, int direction) const { return (node * 4 + static_cast<size_t>(direction)) * static_cast<size_t>(lattice_.candidates); }

  const LabelLattice& lattice_;
  float smoothness_;
  std::vector<float> incoming_;  // [node][direction it comes from][candidate]
};

int8_t LeastOf(const float* values, int count) {
  return count == 0 ? static_cast<int8_t>(-1) : static_cast<int8_t>(std::min_element(values, values + count) - values);
}

// Lets single nodes change to what costs least beside their neighbours, until nothing changes.
void ImproveNodes(const LabelLattice& lattice, double smoothness, std::vector<int8_t>* chosen) {
  bool changed = true;
  for (int sweep = 0; sweep < kMostSweeps && changed; ++sweep) {
    changed = false;
    for (size_t node = 0; node < chosen->size(); ++node) {
      const LabelNode view = NodeOf(lattice, node);
      if (view.count < 2) continue;
      const auto energy_of = [&](int candidate) {
        double energy = static_cast<double>(view.cost[candidate]);
        ForNeighbours(lattice, node, [&](int, size_t neighbour) {
          const int other = (*chosen)[neighbour];
          if (other >= 0) energy += smoothness * static_cast<double>(SeamCost(view, candidate, NodeOf(lattice, neighbour), other));
        });
        return energy;
      };
      int8_t best = (*chosen)[node];
      double least = energy_of(best);
      for (int8_t candidate = 0; candidate < view.count; ++candidate) {
        const double energy = candidate == (*chosen)[node] ? least : energy_of(candidate);
        if (energy < least) {
          least = energy;
          best = candidate;
        }
      }
      changed = changed || best != (*chosen)[node];
      (*chosen)[node] = best;
    }
  }
}

}  // namespace

double LabelEnergy(const LabelLattice& lattice, std::span<const int8_t> chosen, float smoothness) {
  CheckLattice(lattice);
  SKYQUILT_CHECK(chosen.size() == NodesOf(lattice), "one chosen candidate per node is needed");
  double energy = 0.0;
  double seams = 0.0;
  for (size_t node = 0; node < chosen.size(); ++node) {
    if (chosen[node] < 0) continue;
    const LabelNode view = NodeOf(lattice, node);
    SKYQUILT_CHECK(chosen[node] < view.count, "a chosen candidate does not exist");
    energy += static_cast<double>(view.cost[chosen[node]]);
    ForNeighbours(lattice, node, [&](int direction, size_t neighbour) {
      const bool once = direction == 1 || direction == 3;
      if (once && chosen[neighbour] >= 0) {
        seams += static_cast<double>(SeamCost(view, chosen[node], NodeOf(lattice, neighbour), chosen[neighbour]));
      }
    });
  }
  return energy + static_cast<double>(smoothness) * seams;
}

std::vector<int8_t> ChooseLabels(const LabelLattice& lattice, float smoothness, int rounds) {
  CheckLattice(lattice);
  const size_t nodes = NodesOf(lattice);
  const size_t columns = static_cast<size_t>(lattice.columns);
  std::vector<int8_t> cheapest(nodes);
  for (size_t node = 0; node < nodes; ++node) {
    const LabelNode view = NodeOf(lattice, node);
    cheapest[node] = LeastOf(view.cost, view.count);
  }
  Messages messages(lattice, smoothness);
  for (int round = 0; round < 2 * rounds; ++round) {
    for (size_t node = 0; node < nodes; ++node) {
      if ((node / columns + node % columns + static_cast<size_t>(round)) % 2 == 0) messages.Send(node);
    }
  }
  std::vector<int8_t> chosen(nodes);
  for (size_t node = 0; node < nodes; ++node) {
    const LabelNode view = NodeOf(lattice, node);
    const std::array<float, kMostCandidates> sums = messages.Sums(node, view);
    chosen[node] = LeastOf(sums.data(), view.count);
  }
  ImproveNodes(lattice, static_cast<double>(smoothness), &chosen);
  ImproveNodes(lattice, static_cast<double>(smoothness), &cheapest);
  return LabelEnergy(lattice, chosen, smoothness) <= LabelEnergy(lattice, cheapest, smoothness) ? chosen : cheapest;
}

}  // namespace skyquilt::products
