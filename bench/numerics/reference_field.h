// Reference implementation of the field, to check the fast one (batches, single precision): one sample at a time, in double, as simple as possible.
// It takes its shape (levels, offsets, widths) from field::HashField, but shares no arithmetic with it or with the kernels.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/encoding/hash_grid.h"
#include "core/field/hash_field.h"

namespace skyquilt::bench {

// Real spherical harmonics of bands 0..degree-1 from associated Legendre polynomials with the Condon-Shortley phase; degree^2 values, m from -l to l.
std::vector<double> ReferenceHarmonics(const std::array<double, 3>& direction, int degree);

class ReferenceField {
 public:
  // The field must outlive this. Fields with luminance, a normal head, another encoding or a deeper density network are not covered
  // (std::invalid_argument).
  explicit ReferenceField(const field::HashField& field);

  // What a sample stands for: the mean of its positions in the unit box (those outside are moved to its nearest face, NaN counts as 0), and the
  // standard deviation of its footprint, a normal distribution, in unit lengths; 0: a point.
  struct Place {
    std::vector<std::array<double, 3>> positions;
    double deviation = 0.0;
  };
  // Values of the forward pass that the backward pass needs.
  struct Sample {
    Place place;
    std::vector<std::vector<double>> inputs;   // of every layer
    std::vector<std::vector<double>> outputs;  // after the ReLU where there is one
    double log_density = 0.0;                  // output 0 of the density network: log density, before the density bias
    std::array<double, 3> raw = {};            // colours before the sigmoid
  };

  // Features of the hash grid only.
  std::vector<double> Features(std::span<const double> grid, const Place& place) const;
  // Inputs of the density network after these: the share of every second level that the footprint hides. Empty without scale_features.
  std::vector<double> Scales(const Place& place) const;
  Sample Forward(std::span<const double> grid, std::span<const double> networks, const Place& place, const std::array<double, 3>& direction) const;
  // The density only: the colour network is not evaluated, raw stays zero.
  Sample ForwardDensity(std::span<const double> grid, std::span<const double> networks, const Place& place) const;
  // code: of the photo's look; empty: zeros.
  void ForwardColor(std::span<const double> networks, const std::array<double, 3>& direction, std::span<const double> code, Sample* sample) const;
  // Adds to all gradients. code_gradient: as `code` of ForwardColor, and empty where that was.
  void Backward(std::span<const double> networks, const Sample& sample, double log_density_gradient, const std::array<double, 3>& raw_gradient,
                std::span<double> grid_gradient, std::span<double> network_gradient, std::span<double> code_gradient) const;

 private:
  struct Layer {
    size_t outputs = 0, inputs = 0, offset = 0;
    bool relu = false;
  };
  struct Corner {
    size_t first = 0;  // index of the first grid parameter of the entry
    double weight = 0.0;
  };
  // The share of a level's features that the footprint leaves.
  double Weight(int level, const Place& place) const;
  // Entries that a sample reads of a level, with their shares of its feature: eight per position.
  std::vector<Corner> Corners(int level, const Place& place) const;
  void AddCorners(int level, const std::array<double, 3>& position, double share, std::vector<Corner>* corners) const;
  // First input of the colour network that is the code.
  size_t FirstCode() const { return static_cast<size_t>(field_.AppearanceRow()); }
  static std::vector<double> Apply(const Layer& layer, std::span<const double> networks, const std::vector<double>& in);

  const field::HashField& field_;
  encoding::HashGrid grid_;
  std::vector<Layer> layers_;  // density 2, then colour
};

}  // namespace skyquilt::bench
