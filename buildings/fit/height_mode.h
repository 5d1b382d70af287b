// Peaks in the distribution of heights or distances: a start for robust fits that outliers of one side (boxes on a roof, trees before a wall) do not
// move.
#pragma once

#include <optional>
#include <span>
#include <vector>

namespace skyquilt::buildings {

struct Mode {
  double at = 0.0;
  double mass = 0.0;  // weight of the values within two bandwidths
};

// Local maxima of the density of the values, smoothed by a triangle of this half-width, by falling mass. weights: empty (1 each) or one per value.
// NaN values are not allowed. No values: no modes.
std::vector<Mode> Modes(std::span<const double> values, std::span<const double> weights, double bandwidth);

// The lowest mode that has at least `share` of the mass of the heaviest.
std::optional<Mode> LowestStrongMode(std::span<const double> values, double bandwidth, double share);

}  // namespace skyquilt::buildings
