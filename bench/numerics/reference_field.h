// The field once more, one sample at a time, in double and in the plainest way: what the batched single-precision one is compared with. It takes
// its shape (levels, offsets, widths) from field::HashField and shares no arithmetic with it, nor with the kernels.
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
  // The field must outlive this. Fields with luminance, another encoding or a deeper density network are not covered (std::invalid_argument).
  explicit ReferenceField(const field::HashField& field);

  // What forward leaves for backward.
  struct Sample {
    std::array<double, 3> position = {};
    std::vector<std::vector<double>> inputs;   // of every layer
    std::vector<std::vector<double>> outputs;  // after the ReLU where there is one
    double log_depth = 0.0;                    // row 0 of the geometry
    std::array<double, 3> raw = {};            // colours before the sigmoid
  };

  // position in the unit box. Outside of it the nearest place on its faces counts.
  Sample Forward(std::span<const double> grid, std::span<const double> networks, const std::array<double, 3>& position,
                 const std::array<double, 3>& direction) const;
  // The density alone: inputs of the colour network are not made, raw stays zero.
  Sample ForwardDensity(std::span<const double> grid, std::span<const double> networks, const std::array<double, 3>& position) const;
  void ForwardColor(std::span<const double> networks, const std::array<double, 3>& direction, Sample* sample) const;
  // Adds to both gradients.
  void Backward(std::span<const double> networks, const Sample& sample, double log_depth_gradient, const std::array<double, 3>& raw_gradient,
                std::span<double> grid_gradient, std::span<double> network_gradient) const;

 private:
  struct Layer {
    size_t outputs = 0, inputs = 0, offset = 0;
    bool relu = false;
  };
  struct Corner {
    size_t first = 0;  // number of the grid parameters
    double weight = 0.0;
  };
  std::array<Corner, 8> Corners(int level, const std::array<double, 3>& position) const;
  static std::vector<double> Apply(const Layer& layer, std::span<const double> networks, const std::vector<double>& in);

  const field::HashField& field_;
  encoding::HashGrid grid_;
  std::vector<Layer> layers_;  // density 2, then colour
};

}  // namespace skyquilt::bench
