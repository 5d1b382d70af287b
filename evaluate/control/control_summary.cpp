#include "evaluate/control/control_summary.h"

#include <fmt/core.h>

#include <cmath>

namespace skyquilt::evaluate::control {

namespace {

constexpr double kSystematicShare = 0.25;

// Sums of the errors of a group.
class ErrorSums {
 public:
  void Add(const Eigen::Vector3d& error_m, double gsd_m) {
    if (!error_m.head<2>().allFinite()) return;
    const bool has_height = std::isfinite(error_m.z());
    for (int axis = 0; axis < (has_height ? 3 : 2); ++axis) {
      sum_[axis] += error_m[axis];
      sum2_[axis] += error_m[axis] * error_m[axis];
      ++n_[axis];
    }
    if (!(gsd_m > 0.0)) return;
    horizontal2_gsd_ += error_m.head<2>().squaredNorm() / (gsd_m * gsd_m);
    ++n_horizontal_gsd_;
    if (!has_height) return;
    vertical2_gsd_ += error_m.z() * error_m.z() / (gsd_m * gsd_m);
    ++n_vertical_gsd_;
  }

  ControlErrors Result() const {
    ControlErrors errors;
    errors.n = n_[0];
    errors.n_heights = n_[2];
    for (int axis = 0; axis < 3; ++axis) {
      if (n_[axis] == 0) continue;
      const double n = n_[axis], mean = sum_[axis] / n;
      errors.mean_m[axis] = mean;
      errors.rmse_m[axis] = std::sqrt(sum2_[axis] / n);
      if (n_[axis] > 1) errors.sigma_m[axis] = std::sqrt(std::max(sum2_[axis] - n * mean * mean, 0.0) / (n - 1.0));
    }
    errors.rmse_horizontal_m = errors.rmse_m.head<2>().norm();
    errors.rmse_vertical_m = errors.rmse_m.z();
    if (n_horizontal_gsd_ > 0) errors.rmse_horizontal_gsd = std::sqrt(horizontal2_gsd_ / n_horizontal_gsd_);
    if (n_vertical_gsd_ > 0) errors.rmse_vertical_gsd = std::sqrt(vertical2_gsd_ / n_vertical_gsd_);
    return errors;
  }

 private:
  Eigen::Vector3d sum_ = Eigen::Vector3d::Zero(), sum2_ = Eigen::Vector3d::Zero();
  Eigen::Vector3i n_ = Eigen::Vector3i::Zero();
  double horizontal2_gsd_ = 0.0, vertical2_gsd_ = 0.0;
  int n_horizontal_gsd_ = 0, n_vertical_gsd_ = 0;
};

// Mean of squares of what is known.
class SquareMean {
 public:
  void Add(double value) {
    if (!std::isfinite(value)) return;
    sum2_ += value * value;
    ++n_;
  }
  double Root() const { return n_ > 0 ? std::sqrt(sum2_ / n_) : kNotMeasured; }

 private:
  double sum2_ = 0.0;
  int n_ = 0;
};

std::string InCentimetres(double metres) {
  return fmt::format("{:.1f} cm", 100.0 * metres);
}

// With the accuracy of the check points' survey, where it is known.
double Including(double rmse_m, double given_m) {
  return std::isfinite(given_m) ? std::hypot(rmse_m, given_m) : rmse_m;
}

}  // namespace

std::array<bool, 3> ControlErrors::Systematic() const {
  std::array<bool, 3> systematic{};
  for (int axis = 0; axis < 3; ++axis) systematic[static_cast<size_t>(axis)] = std::abs(mean_m[axis]) > kSystematicShare * rmse_m[axis];
  return systematic;
}

std::array<bool, 3> ControlErrors::SystematicBeyondChance() const {
  std::array<bool, 3> systematic = Systematic();
  for (int axis = 0; axis < 3; ++axis) {
    const double standard_error_m = sigma_m[axis] / std::sqrt(static_cast<double>(axis < 2 ? n : n_heights));
    bool& one = systematic[static_cast<size_t>(axis)];
    one = one && std::abs(mean_m[axis]) > 2.0 * standard_error_m;
  }
  return systematic;
}

std::optional<bool> ControlErrors::WithinRule() const {
  if (!std::isfinite(rmse_horizontal_gsd)) return std::nullopt;
  return rmse_horizontal_gsd <= kMostHorizontal_gsd && !(rmse_vertical_gsd > kMostVertical_gsd);
}

const ControlErrors* ControlSummary::Judged() const {
  if (check.n > 0) return &check;
  return left_out.n > 0 ? &left_out : nullptr;
}

ControlSummary SummariseControl(const survey::ControlFit& fit) {
  ErrorSums control, left_out, check;
  SquareMean given_horizontal, given_vertical;
  ControlSummary summary;
  for (const survey::ControlPointFit& point : fit.points) {
    switch (point.use) {
      case survey::ControlUse::kControl:
        control.Add(point.error_m, point.gsd_m);
        left_out.Add(point.left_out_error_m, point.gsd_m);
        break;
      case survey::ControlUse::kCheck:
        check.Add(point.error_m, point.gsd_m);
        // Both horizontal axes.
        given_horizontal.Add(std::sqrt(2.0) * point.given_sigma_m.x());
        if (std::isfinite(point.error_m.z())) given_vertical.Add(point.given_sigma_m.y());
        break;
      case survey::ControlUse::kRejected:
        ++summary.n_rejected;
        break;
      case survey::ControlUse::kUnseen:
        ++summary.n_unseen;
        break;
    }
  }
  summary.control = control.Result();
  summary.left_out = left_out.Result();
  summary.check = check.Result();
  summary.given_horizontal_m = given_horizontal.Root();
  summary.given_vertical_m = given_vertical.Root();
  return summary;
}

std::string AccuracyStatement(const ControlSummary& summary) {
  constexpr const char* kStandards = "ASPRS Positional Accuracy Standards for Digital Geospatial Data, Edition 2 (2023)";
  const ControlErrors& check = summary.check;
  if (check.n < kLeastCheckPoints) {
    const std::string there_are = check.n == 0 ? "There are no check points" : fmt::format("There are fewer than 30 check points ({})", check.n);
    return fmt::format("{}. The {} state an accuracy from at least 30; the figures here describe these points only.", there_are, kStandards);
  }
  std::string text = fmt::format("Tested with {} check points as in the {}: horizontal accuracy RMSE_H = {}", check.n, kStandards,
                                 InCentimetres(Including(check.rmse_horizontal_m, summary.given_horizontal_m)));
  const bool heights = check.n_heights >= kLeastCheckPoints;
  if (heights) text += ", vertical accuracy RMSE_V = " + InCentimetres(Including(check.rmse_vertical_m, summary.given_vertical_m));
  text += ".";
  if (!heights) text += fmt::format(" Fewer than 30 of them ({}) have heights: no vertical accuracy is stated.", check.n_heights);
  if (!std::isfinite(summary.given_horizontal_m)) return text + " The accuracy of the check points' own survey is not known and not included.";
  text += " The accuracy of the check points' own survey is included: " + InCentimetres(summary.given_horizontal_m) + " horizontally";
  if (heights && std::isfinite(summary.given_vertical_m)) text += ", " + InCentimetres(summary.given_vertical_m) + " vertically";
  return text + ".";
}

}  // namespace skyquilt::evaluate::control
