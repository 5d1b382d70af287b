// The parts of the bench about scales, and what they share: methods of training, their scores as tables, charts and sentences.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/bench_page.h"
#include "bench/study/compare.h"
#include "bench/study/study.h"
#include "bench/study/study_benches.h"

namespace skyquilt::bench {

// How samples see a scene, and what they learn from.
struct ScaleMethod {
  int positions = 0;     // train.multisample: 0: samples are points, without footprint
  bool pyramid = false;  // rays from photos of several sizes

  std::string Name() const;   // "points_photos", "cones4_pyramid"
  std::string Label() const;  // "points, photos", "cones of 4, pyramid"
  std::vector<config::Override> Overrides() const;
};

// All trainings of one method, which differ in their random numbers.
struct MethodResults {
  ScaleMethod method;
  std::string label;
  std::vector<VariantResult> seeds;

  // Medians over the seeds that have the score; NaN when none has.
  double Psnr(const std::string& group, int divisor, bool averaged) const;
  double FrameSeconds(const std::string& group, int divisor) const;
  const VariantResult& First() const { return seeds.front(); }
};

// Of the PSNR with one ray per pixel; both have the same seeds in the same order.
Difference PsnrDifferenceAt(const MethodResults& of, const MethodResults& against, const std::string& group, int divisor);
// Rows: each method with one ray per pixel, and with the full frame averaged. Columns: widths.
BenchTable ScaleTable(const std::vector<MethodResults>& methods, const std::string& name);
// Seconds per frame at each width.
BenchTable FrameTimeTable(const std::vector<MethodResults>& methods, const std::string& name);
// One row per training with its photos, steps and scores.
BenchTable TrainingTable(const std::vector<MethodResults>& methods, const std::string& name);
// PSNR over the divisor of the width.
std::string ScaleChart(const std::vector<MethodResults>& methods, const std::string& title);
// The method with cones that has the highest PSNR at divisors above 1, on average over them; null when none was scored.
const MethodResults* BestCones(const std::vector<MethodResults>& methods);
const MethodResults* Find(const std::vector<MethodResults>& methods, const ScaleMethod& method);
// The best method with cones against points, at each width, and whether small frames are as fast as they should be. condition: of all trainings.
std::vector<std::string> ScaleVerdicts(const std::vector<MethodResults>& methods, const std::string& condition);
// "1/8", and "1" for 1.
std::string FractionName(int divisor);
// "1/8 of the width", and "full width".
std::string WidthName(int divisor);
// The distinct divisors that were scored, rising.
std::vector<int> DivisorsOf(const std::vector<MethodResults>& methods);

// Overrides of every method's variant, by the place of the seed in the list of seeds.
using SeedOverrides = std::function<std::vector<config::Override>(size_t seed)>;
// Trains `methods` as variants "<part>_<method>", as Study::WithSeed names them. like: its photos are those of every variant, its label follows that
// of the method.
std::vector<MethodResults> RunMethods(Study& study, const std::string& part, const std::vector<ScaleMethod>& methods, const ScalesOptions& options,
                                      const Variant& like, const SeedOverrides& own);

// Trains with photos of several heights and adds the section and its verdicts to the bench. Throws base::UsageError.
void AddHeights(const Study& study, const ScalesOptions& options, StudyBench* bench);

}  // namespace skyquilt::bench
