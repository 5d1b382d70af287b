// What the points say about the parameters of a shape: residuals in metres with their derivatives.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "buildings/building.h"
#include "buildings/fit/fit_parameters.h"

namespace skyquilt::buildings {

enum class ObservationKind : uint8_t {
  kRoof,   // distance of a point from a plane of a roof
  kLine,   // distance of a point from where line and overhang put wall or rim
  kPrior,  // difference of one parameter from a value
};

struct Observation {
  ObservationKind kind = ObservationKind::kRoof;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();  // ENU minus the shape's origin
  double height = 0.0;                              // of a roof point, ENU z
  double tilt = 1.0;                                // cosine of the roof's pitch: from height differences to distances
  double value = 0.0;                               // of a prior; else subtracted from the distance: a known systematic error
  // A roof plane rises from this wall line inwards, or points are near it.
  int axis = 0, line = 0, side = 1;
  int part = 0;
  // The two lines of which half the distance is the way from eave to ridge; axis of those lines. Roofs of one height have none.
  int half_axis = 0, half_low = -1, half_high = -1;
  int parameter = 0;   // of a prior; of a point near a line: the overhang that counts
  double reach = 0.0;  // how much of that overhang is in front of the line where the point is: 1 at the rim of the roof
  double trust = 1.0;  // its weight relative to others of its group
};

// gradient: of the residual with respect to all parameters, may be null.
double Residual(const Observation& observation, const Parameters& parameters, const double* values, double* gradient);

// Observations that share noise and systematic error: the points of one roof plane, of one wall, of one roof edge.
struct Group {
  std::vector<Observation> observations;
  std::vector<Eigen::Vector2d> at;  // where the observations are on their surface, metres
  double area_m2 = 0.0;             // of the surface that they stand for
  double scale_m = 0.0;             // residuals beyond count less and less (Cauchy); 0: all count alike
  double sigma_m = 0.1;             // of one observation
  double n_eff = 1.0;               // how many of them are independent
  double common_m = 0.0;            // standard deviation of an error that all have in common

  // Of an observation: one over its variance, so that the group as a whole weighs what it knows.
  double Weight() const;
  // Keeps every n-th, so that no more than `most` remain: neighbouring points hardly tell more.
  void Thin(size_t most);
};

}  // namespace skyquilt::buildings
