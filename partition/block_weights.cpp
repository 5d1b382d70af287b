#include "partition/block_weights.h"

#include <algorithm>

namespace skyquilt::partition {
namespace {

// Rises from 0 at edge - margin to 1 at edge + margin.
double Ramp(double distance, double margin) {
  if (margin <= 0.0) return distance >= 0.0 ? 1.0 : 0.0;
  const double u = std::clamp(0.5 * (distance / margin + 1.0), 0.0, 1.0);
  return u * u * (3.0 - 2.0 * u);
}

// One minus the ramp of the upper edge, so that neighbours computed from the same edge agree to rounding.
double Window(double value, double low, double high, double margin) {
  return Ramp(value - low, margin) * (1.0 - Ramp(value - high, margin));
}

}  // namespace

double BlockWeight(const Block& block, double x, double y) {
  if (!(x == x) || !(y == y)) return 0.0;
  return Window(x, block.min_enu.x(), block.max_enu.x(), block.margin_m) * Window(y, block.min_enu.y(), block.max_enu.y(), block.margin_m);
}

std::vector<double> BlockWeights(const BlockSet& blocks, double x, double y) {
  std::vector<double> weights;
  weights.reserve(blocks.blocks.size());
  double sum = 0.0;
  for (const Block& block : blocks.blocks) {
    weights.push_back(block.empty ? 0.0 : BlockWeight(block, x, y));
    sum += weights.back();
  }
  if (sum > 0.0) {
    for (double& weight : weights) weight /= sum;
  }
  return weights;
}

}  // namespace skyquilt::partition
