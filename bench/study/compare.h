// Whether two variants of a study differ by more than chance. Equal trainings do not reach equal scores: with other random numbers, and within a time
// budget even with the same ones. So a difference counts only when it is larger than the noise:
//   Trainings with the same seed (and place) are pairs. The difference is the median over the pairs.
//   From three pairs on, the noise is t * sqrt(pi / 2) * standard deviation / sqrt(pairs): the standard error of a median of normal values, times the
//   97.5th percentile of Student's t. Equal variants then look different in 3 to 4 % of cases, and more seeds make smaller differences visible.
//   Fewer pairs say too little of their own spread; their noise is that of single trainings.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/study/study.h"

namespace skyquilt::bench {

// Of the PSNR of single trainings: docs/benchmarks.md, "What a decibel means".
inline constexpr double kNoise_db = 0.3;

struct Difference {
  int pairs = 0;
  double median = std::numeric_limits<double>::quiet_NaN();  // NaN without pairs
  double noise = std::numeric_limits<double>::quiet_NaN();   // NaN: unknown
  bool seen = false;                                         // larger than the noise
};
// differences: one per pair; those that are not finite do not count. single_noise: of single trainings; NaN: unknown.
Difference DifferenceOf(std::vector<double> differences, double single_noise);

// The PSNR by which results are compared: over common pixels when all that have a PSNR have that one, else each over its own pixels.
std::vector<double> ComparablePsnr(const std::vector<const VariantResult*>& results);
// Of `of` minus that of `against`, in dB; their trainings have the same seeds in the same order.
Difference PsnrDifference(const VariantResult& of, const VariantResult& against);

// "+1.20 dB", "no difference seen (+0.12 dB, noise up to 0.3 dB)", "not measured". The number alone when the noise is unknown.
std::string Shown(const Difference& difference, int decimals = 2, const std::string& unit = " dB");
// A key figure in dB that says when no difference is seen.
BenchFigure DifferenceFigure(const std::string& label, const Difference& difference, const std::string& note);

template <typename Results>
auto PointersTo(Results& results) {
  std::vector<decltype(&results.front())> pointers;
  pointers.reserve(results.size());
  for (auto& result : results) pointers.push_back(&result);
  return pointers;
}

}  // namespace skyquilt::bench
