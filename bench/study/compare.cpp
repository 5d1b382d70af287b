#include "bench/study/compare.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "bench/study/study_tables.h"
#include "core/base/order_statistics.h"

namespace skyquilt::bench {
namespace {

constexpr size_t kFewestPairs = 3;
constexpr double kMedianOverMean = 1.2533141;  // sqrt(pi / 2): standard error of a median of normal values over that of their mean

// 97.5th percentile of Student's t for so many pairs, at least three. Above eleven that of eleven, which is a little too large for them.
double StudentT(size_t pairs) {
  constexpr std::array<double, 9> kFromThree = {4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
  return kFromThree[std::min(pairs - kFewestPairs, kFromThree.size() - 1)];
}

double StandardDeviation(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double sum = 0.0;
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / (n - 1.0));
}

std::string NoiseText(const Difference& difference, const std::string& unit) {
  return fmt::format("noise up to {:.2g}{}", difference.noise, unit);
}

}  // namespace

Difference DifferenceOf(std::vector<double> differences, double single_noise) {
  std::erase_if(differences, [](double value) { return !std::isfinite(value); });
  Difference difference{.pairs = static_cast<int>(differences.size())};
  if (differences.empty()) return difference;
  const size_t pairs = differences.size();
  difference.noise = pairs < kFewestPairs
                         ? single_noise
                         : StudentT(pairs) * kMedianOverMean * StandardDeviation(differences) / std::sqrt(static_cast<double>(pairs));
  difference.median = base::Median(std::move(differences));
  difference.seen = std::abs(difference.median) > difference.noise;
  return difference;
}

std::vector<double> ComparablePsnr(const std::vector<const VariantResult*>& results) {
  const bool common =
      std::all_of(results.begin(), results.end(), [](const VariantResult* r) { return std::isnan(r->psnr_db) || std::isfinite(r->psnr_common_db); });
  std::vector<double> psnr_db;
  psnr_db.reserve(results.size());
  for (const VariantResult* r : results) psnr_db.push_back(common ? r->psnr_common_db : r->psnr_db);
  return psnr_db;
}

Difference PsnrDifference(const VariantResult& of, const VariantResult& against) {
  if (of.seeds.empty() || against.seeds.empty()) {
    const std::vector<double> psnr_db = ComparablePsnr({&of, &against});
    return DifferenceOf({psnr_db[0] - psnr_db[1]}, kNoise_db);
  }
  std::vector<double> differences;
  for (size_t i = 0; i < std::min(of.seeds.size(), against.seeds.size()); ++i) {
    const std::vector<double> psnr_db = ComparablePsnr({&of.seeds[i], &against.seeds[i]});
    differences.push_back(psnr_db[0] - psnr_db[1]);
  }
  return DifferenceOf(std::move(differences), kNoise_db);
}

std::string Shown(const Difference& difference, int decimals, const std::string& unit) {
  if (difference.pairs == 0) return "not measured";
  const std::string number = Signed(difference.median, decimals) + unit;
  if (difference.seen || std::isnan(difference.noise)) return number;
  return fmt::format("no difference seen ({}, {})", number, NoiseText(difference, unit));
}

BenchFigure DifferenceFigure(const std::string& label, const Difference& difference, const std::string& note) {
  const bool unseen = difference.pairs > 0 && !difference.seen;
  return {label, difference.pairs == 0 ? "not measured" : Signed(difference.median, 2) + " dB",
          unseen ? fmt::format("{}; no difference seen, {}", note, NoiseText(difference, " dB")) : note};
}

}  // namespace skyquilt::bench
