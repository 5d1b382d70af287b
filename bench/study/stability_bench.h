// `bench stability`: trains surveys over blocks, seeds, learning rates, budgets and extremes, and looks for trainings that fall apart.
#pragma once

#include <string>
#include <vector>

#include "bench/study/study_benches.h"

namespace skyquilt::bench {

// What is done to a survey beside SurveyEdits(): another height, or a tiny batch.
std::vector<std::string> StabilityExtremes();

struct StabilityOptions {
  // Every combination of these is trained.
  std::vector<std::string> blocks = {"auto", "1x1", "4x4"};
  std::vector<int> seeds = {1, 2};
  std::vector<double> rates = {1.0, 2.0, 4.0};  // factors on the learning rates
  std::vector<double> budgets_s = {20.0};
  // Each is trained once, with the first of the others.
  std::vector<std::string> extremes = StabilityExtremes();
};

// One run: a variant of one survey.
struct StabilityRun {
  std::string survey, extreme;  // extreme: empty for none
  std::string blocks;
  int seed = 1;
  double rate = 1.0, budget_s = 0.0;
  VariantResult result;
  std::string refused;  // the reason, for a survey that cannot be trained; `result` is then empty

  int Falls() const;          // taken back, of all fields
  int ContextBlocks() const;  // that show the context
  double WorstFall() const;   // dB, of any field; NaN when unknown
  double WorstEnd() const;    // dB below its best, of any field that is shown; NaN when unknown
};

// Largest allowed value of WorstEnd().
constexpr double kMostBelowBest_db = 0.5;

// The runs of one survey, in order. Finished runs are read from the study's folder. A run that a stage refuses has its reason.
std::vector<StabilityRun> RunStability(Study& study, const std::string& survey, const StabilityOptions& options);
BenchPage StabilityPage(const std::vector<StabilityRun>& runs);

}  // namespace skyquilt::bench
