#include "buildings/fit/roof_choice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "buildings/fit/height_mode.h"
#include "core/base/order_statistics.h"

namespace skyquilt::buildings {
namespace {

constexpr double kLeastRise = 0.1;  // of a pitched roof, metres per metre: 5.7 degrees
constexpr double kMostRise = 4.0;
constexpr double kStrongMode = 0.4;  // of the heaviest mode: a deck under large boxes, but not a few stray points
constexpr size_t kMostChoicePoints = 2000;
constexpr int kBins = 12;

// A point as a roof with two free numbers sees it: height = eave + rise * distance.
struct Sample {
  double distance, height;
};

// Distance into the roof from its nearest eave; negative outside the walls.
double DistanceInside(const Eigen::Vector3d& point, const Eigen::Vector2d& low, const Eigen::Vector2d& high, RoofKind roof, bool along_u) {
  const Eigen::Array2d inside = (point.head<2>() - low).cwiseMin(high - point.head<2>()).array();
  return roof == RoofKind::kHip ? inside.minCoeff() : inside[along_u ? 1 : 0];
}

struct Line {
  double eave = 0.0, rise = 0.0;

  double Residual(const Sample& sample) const { return (sample.height - eave - rise * sample.distance) / std::sqrt(1.0 + rise * rise); }
};

// Median slope between the medians of strips: outliers in a strip, and strips of outliers, do not count.
Line StartOf(const std::vector<Sample>& samples, double reach) {
  std::array<std::vector<double>, kBins> strip;
  for (const Sample& sample : samples) {
    if (sample.distance < 0.0) continue;
    const auto bin = static_cast<size_t>(sample.distance / reach * kBins);
    strip[std::min(bin, strip.size() - 1)].push_back(sample.height);
  }
  std::vector<Sample> middles;
  const double least = 0.2 * static_cast<double>(samples.size()) / kBins;
  for (size_t i = 0; i < strip.size(); ++i) {
    if (strip[i].empty() || static_cast<double>(strip[i].size()) < least) continue;
    middles.push_back({(static_cast<double>(i) + 0.5) * reach / kBins, base::Median(std::move(strip[i]))});
  }
  std::vector<double> rises, eaves;
  for (size_t i = 0; i < middles.size(); ++i) {
    for (size_t k = i + 1; k < middles.size(); ++k) {
      rises.push_back((middles[k].height - middles[i].height) / (middles[k].distance - middles[i].distance));
    }
  }
  Line line;
  line.rise = rises.empty() ? kLeastRise : std::clamp(base::Median(std::move(rises)), kLeastRise, kMostRise);
  for (const Sample& sample : samples) eaves.push_back(sample.height - line.rise * sample.distance);
  line.eave = base::Median(std::move(eaves));
  return line;
}

// One step of iteratively reweighted least squares with a Cauchy loss; the rise stays between its limits.
Line Improved(const std::vector<Sample>& samples, const Line& line, double scale) {
  double w = 0.0, wd = 0.0, wz = 0.0, wdd = 0.0, wdz = 0.0;
  for (const Sample& sample : samples) {
    const double r = line.Residual(sample) / scale;
    const double weight = 1.0 / (1.0 + r * r);
    w += weight;
    wd += weight * sample.distance;
    wz += weight * sample.height;
    wdd += weight * sample.distance * sample.distance;
    wdz += weight * sample.distance * sample.height;
  }
  const double spread = wdd - wd * wd / w;
  Line better = line;
  if (spread > 1e-9 * (1.0 + wdd)) better.rise = std::clamp((wdz - wd * wz / w) / spread, kLeastRise, kMostRise);
  better.eave = (wz - better.rise * wd) / w;
  return better;
}

Line FitLine(const std::vector<Sample>& samples, double reach, double scale) {
  Line line = StartOf(samples, reach);
  for (const double wide : {4.0, 2.0, 1.0}) {
    for (int step = 0; step < 12; ++step) {
      const Line better = Improved(samples, line, wide * scale);
      const double change = std::abs(better.eave - line.eave) + reach * std::abs(better.rise - line.rise);
      line = better;
      if (change < 1e-6) break;
    }
  }
  return line;
}

// The height of a flat roof: its lowest strong level, refined.
double FitLevel(const std::vector<double>& heights, double scale) {
  double level = LowestStrongMode(heights, scale, kStrongMode).value_or(Mode{}).at;
  for (int step = 0; step < 20; ++step) {
    double sum = 0.0, total = 0.0;
    for (const double height : heights) {
      const double r = (height - level) / scale;
      const double weight = 1.0 / (1.0 + r * r) / (1.0 + r * r);  // falls faster than Cauchy's: what stands on the deck is on one side of it
      sum += weight * height;
      total += weight;
    }
    if (!(total > 0.0)) break;
    const double better = sum / total;
    const bool done = std::abs(better - level) < 1e-6;
    level = better;
    if (done) break;
  }
  return level;
}

// Of residuals, relative to the information of n_eff points: twice the negative logarithm of a Cauchy likelihood of this scale.
void Score(const std::vector<double>& residuals, double tolerance_m, double n_eff, int parameters, RoofFit* fit) {
  const double scale = 0.5 * tolerance_m;
  double sum = 0.0;
  size_t within = 0;
  for (const double r : residuals) {
    sum += 2.0 * std::log1p(r * r / (scale * scale));
    if (std::abs(r) <= tolerance_m) ++within;
  }
  const auto n = static_cast<double>(residuals.size());
  fit->bic = n_eff / n * sum + parameters * std::log(std::max(n_eff, 1.0));
  fit->share_within = static_cast<double>(within) / n;
}

RoofFit FlatFit(const std::vector<Eigen::Vector3d>& points, double tolerance_m, double n_eff) {
  std::vector<double> heights;
  heights.reserve(points.size());
  for (const Eigen::Vector3d& point : points) heights.push_back(point.z());
  RoofFit fit;
  fit.eave_z = fit.ridge_z = FitLevel(heights, 0.5 * tolerance_m);
  for (double& height : heights) height -= fit.eave_z;
  Score(heights, tolerance_m, n_eff, 1, &fit);
  return fit;
}

RoofFit PitchedFit(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector2d& low, const Eigen::Vector2d& high, RoofKind roof, bool along_u,
                   double tolerance_m, double n_eff) {
  const Eigen::Vector2d half = 0.5 * (high - low);
  const double reach = std::max(roof == RoofKind::kHip ? half.minCoeff() : half[along_u ? 1 : 0], 1e-3);
  std::vector<Sample> samples;
  samples.reserve(points.size());
  for (const Eigen::Vector3d& point : points) samples.push_back({DistanceInside(point, low, high, roof, along_u), point.z()});
  const Line line = FitLine(samples, reach, 0.5 * tolerance_m);
  RoofFit fit{roof, along_u, line.eave, line.eave + line.rise * reach};
  std::vector<double> residuals;
  residuals.reserve(samples.size());
  for (const Sample& sample : samples) residuals.push_back(line.Residual(sample));
  Score(residuals, tolerance_m, n_eff, 2, &fit);
  return fit;
}

}  // namespace

RoofFit ChooseRoof(std::span<const Eigen::Vector3d> points, const Eigen::Vector2d& min_uv, const Eigen::Vector2d& max_uv, double tolerance_m,
                   double n_eff) {
  const Eigen::Vector2d size = max_uv - min_uv;
  const bool longer_u = size.x() >= size.y();
  if (points.empty()) return {RoofKind::kFlat, longer_u};
  std::vector<Eigen::Vector3d> chosen;
  const double step = std::max(1.0, static_cast<double>(points.size()) / static_cast<double>(kMostChoicePoints));
  for (double i = 0.0; i < static_cast<double>(points.size()); i += step) chosen.push_back(points[static_cast<size_t>(i)]);
  n_eff = std::max(n_eff, 1.0);

  RoofFit best = FlatFit(chosen, tolerance_m, n_eff);
  best.along_u = longer_u;
  for (const RoofFit& fit : {PitchedFit(chosen, min_uv, max_uv, RoofKind::kGable, true, tolerance_m, n_eff),
                             PitchedFit(chosen, min_uv, max_uv, RoofKind::kGable, false, tolerance_m, n_eff),
                             PitchedFit(chosen, min_uv, max_uv, RoofKind::kHip, longer_u, tolerance_m, n_eff)}) {
    if (fit.bic < best.bic) best = fit;
  }
  return best;
}

}  // namespace skyquilt::buildings
