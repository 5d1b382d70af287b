// Errors of tagged heights that change slowly: offsets between flights, drift and wandering of a barometer or receiver. They are linear in a few
// parameters per flight, with prior standard deviations that the tags themselves choose.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace skyquilt::prepare::georeference {

// Prior standard deviations, metres.
struct BiasSigmas {
  double offset_m = 0.0;  // of a flight against the reference flight
  double drift_m = 0.0;   // linear rise over a flight
  double wander_m = 0.0;  // random walk over a flight, at its end
};

class HeightBias {
 public:
  // No bias at all.
  HeightBias() = default;
  // Per tag: its flight and its phase in it (-0.5 to 0.5). The reference flight has no offset.
  HeightBias(const std::vector<int>& flight, const std::vector<double>& phase, int reference_flight);

  // tags x parameters: bias in metres of each tag. Within a flight every column has mean zero except the offset, so heights refer to the middle of a
  // flight.
  const Eigen::MatrixXd& basis() const { return basis_; }
  Eigen::Index size() const { return basis_.cols(); }
  // Prior standard deviation of each parameter; never zero.
  Eigen::VectorXd Sigmas(const BiasSigmas& sigmas) const;

 private:
  enum class Kind { kOffset, kDrift, kWander };
  Eigen::MatrixXd basis_;
  std::vector<Kind> kind_;
  std::vector<double> share_;  // of the variance, for the steps of a random walk
};

// Heights of tags less the heights of the levelled reconstruction, to be explained by one height, a tilt and the bias.
struct HeightObservations {
  Eigen::VectorXd height_m;          // residual heights
  Eigen::VectorXd sigma;             // relative accuracy of each tag; infinity: not used
  Eigen::MatrixX2d tilt;             // change of the reconstruction's height for a small rotation (radians) about east and north
  Eigen::Matrix2d tilt_information;  // of gravity, for that rotation; 1/rad^2
};

struct BiasChoice {
  BiasSigmas sigmas;
  // The solution: height (metres), tilt (radians, about east and north) and bias parameters. A start for the adjustment.
  Eigen::VectorXd solution;
};

// Chooses the prior standard deviations by their marginal likelihood: the base hypothesis (offsets and drifts of the size of the noise) unless a
// larger one is clearly more likely. Robust against outliers.
BiasChoice ChooseBias(const HeightObservations& observations, const HeightBias& bias);

}  // namespace skyquilt::prepare::georeference
