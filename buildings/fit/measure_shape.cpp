#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "buildings/fit/fit_parameters.h"
#include "buildings/fit/fit_shape.h"
#include "buildings/fit/roof_pieces.h"

namespace skyquilt::buildings {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kStep_m = 1e-4;  // of the differences

// In the order of Measures.
enum Figure : int { kGround, kEave, kRidge, kHeight, kLength, kWidth, kYaw, kFootprint, kRoof, kVolume, kPitch, kFigures };
using Figures = Eigen::Array<double, kFigures, 1>;

const Part& LargestPart(const Shape& shape) {
  const auto area = [&](const Part& part) { return (shape.MaxOf(part, false) - shape.MinOf(part, false)).prod(); };
  return *std::max_element(shape.parts.begin(), shape.parts.end(), [&](const Part& a, const Part& b) { return area(a) < area(b); });
}

const Part& HighestPart(const Shape& shape) {
  return *std::max_element(shape.parts.begin(), shape.parts.end(), [](const Part& a, const Part& b) { return a.ridge_z < b.ridge_z; });
}

// The rectangle around all walls.
struct Extent {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;

  Eigen::Vector2d Middle() const { return 0.5 * (low + high); }
  Eigen::Vector2d Size() const { return high - low; }
};
Extent ExtentOf(const Shape& shape) {
  Extent extent;
  for (const Part& part : shape.parts) {
    extent.low = extent.low.cwiseMin(shape.MinOf(part, false));
    extent.high = extent.high.cwiseMax(shape.MaxOf(part, false));
  }
  return extent;
}

double PitchOf(const Shape& shape, const Part& part) {
  if (!IsPitched(part)) return 0.0;
  const Eigen::Vector2d half = 0.5 * (shape.MaxOf(part, false) - shape.MinOf(part, false));
  const double reach = part.roof == RoofKind::kHip ? half.minCoeff() : half[part.along_u ? 1 : 0];
  return std::atan2(part.ridge_z - part.eave_z, reach) / kDegree;
}

// Which parts and sides the figures are of: those of the fitted shape, also when a difference would change the choice.
struct Choice {
  size_t largest = 0, highest = 0;
  bool length_u = true;
};

Figures FiguresOf(const Shape& shape, const Choice& choice) {
  const Part& largest = shape.parts[choice.largest];
  const Part& highest = shape.parts[choice.highest];
  const Eigen::Vector2d size = ExtentOf(shape).Size();
  const RoofTotals totals = TotalsOf(shape);
  Figures figures;
  figures[kGround] = shape.ground_z;
  figures[kEave] = largest.eave_z;
  figures[kRidge] = highest.ridge_z;
  figures[kHeight] = highest.ridge_z - shape.ground_z;
  figures[kLength] = size[choice.length_u ? 0 : 1];
  figures[kWidth] = size[choice.length_u ? 1 : 0];
  figures[kYaw] = shape.yaw_rad / kDegree + (choice.length_u ? 0.0 : 90.0);
  figures[kFootprint] = totals.plan_m2;
  figures[kRoof] = totals.sloped_m2;
  figures[kVolume] = totals.volume_m3;
  figures[kPitch] = PitchOf(shape, largest);
  return figures;
}

// The shape with the i-th parameter of the covariance changed; the last is the ground.
Shape Changed(const Shape& shape, const Parameters& parameters, int i, double change) {
  Shape changed = shape;
  if (i == parameters.shape_size()) {
    changed.ground_z += change;
    return changed;
  }
  Eigen::VectorXd values = parameters.Of(shape);
  values[i] += change;
  parameters.Set(values, &changed);
  return changed;
}

double KnownOr0(double value) {
  return std::isfinite(value) ? value : 0.0;
}

// Variances that the place of the survey on Earth adds.
Figures PlaceVariances(const Shape& shape, const Choice& choice, const Figures& figures, const geo::PlaceAccuracy& accuracy) {
  const double scale = 0.01 * KnownOr0(accuracy.scale_percent);
  const double tilt = KnownOr0(accuracy.tilt_deg) * kDegree / std::numbers::sqrt2;  // about one horizontal axis
  const double vertical = KnownOr0(accuracy.vertical_m);
  const Eigen::Vector2d middle = ExtentOf(shape).Middle();
  const auto from_middle = [&](size_t p) {
    const Part& part = shape.parts[p];
    return (0.5 * (shape.MinOf(part, false) + shape.MaxOf(part, false)) - middle).norm();
  };
  // Heights of the survey's middle are known to vertical_m; a tilt lifts what is away from it, and the survey's origin is near it.
  const double lift = tilt * shape.EnuFrom(middle).norm();
  Figures variances = Figures::Zero();
  for (const Figure height : {kGround, kEave, kRidge}) variances[height] = vertical * vertical + lift * lift;
  // Ground is measured at the middle of the footprint, the ridge at the middle of its part.
  const double apart = tilt * from_middle(choice.highest), growth = scale * figures[kHeight];
  variances[kHeight] = apart * apart + growth * growth;
  for (const auto& [figure, power] :
       {std::pair(kLength, 1.0), std::pair(kWidth, 1.0), std::pair(kFootprint, 2.0), std::pair(kRoof, 2.0), std::pair(kVolume, 3.0)}) {
    variances[figure] = std::pow(power * scale * figures[figure], 2);
  }
  variances[kYaw] = std::pow(KnownOr0(accuracy.yaw_deg), 2);
  return variances;
}

}  // namespace

Measures MeasureShape(const FittedShape& fitted, const FitOptions& options) {
  const Shape& shape = fitted.shape;
  const Parameters parameters(shape);
  Choice choice;
  choice.largest = static_cast<size_t>(&LargestPart(shape) - shape.parts.data());
  choice.highest = static_cast<size_t>(&HighestPart(shape) - shape.parts.data());
  const Eigen::Vector2d size = ExtentOf(shape).Size();
  choice.length_u = size.x() >= size.y();
  Figures figures = FiguresOf(shape, choice);

  const int n = parameters.shape_size() + 1;
  Eigen::MatrixXd derivative(static_cast<int>(kFigures), n);
  for (int i = 0; i < n; ++i) {
    derivative.col(i) =
        (FiguresOf(Changed(shape, parameters, i, kStep_m), choice) - FiguresOf(Changed(shape, parameters, i, -kStep_m), choice)) / (2.0 * kStep_m);
  }
  const Figures place = PlaceVariances(shape, choice, figures, options.accuracy);
  figures[kYaw] -= 180.0 * std::floor(figures[kYaw] / 180.0);

  Measures measures;
  const std::array<Measure*, kFigures> target = {&measures.ground_m, &measures.eave_m,    &measures.ridge_m,  &measures.height_m,
                                                 &measures.length_m, &measures.width_m,   &measures.yaw_deg,  &measures.footprint_m2,
                                                 &measures.roof_m2,  &measures.volume_m3, &measures.pitch_deg};
  const bool known = fitted.covariance.rows() == n && fitted.covariance.cols() == n;
  for (int i = 0; i < kFigures; ++i) {
    target[static_cast<size_t>(i)]->value = figures[i];
    if (!known) continue;
    const double own = derivative.row(i).dot(fitted.covariance * derivative.row(i).transpose());
    target[static_cast<size_t>(i)]->sigma = std::sqrt(std::max(own, 0.0) + place[i]);
  }
  return measures;
}

}  // namespace skyquilt::buildings
