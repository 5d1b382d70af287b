#include <fmt/core.h>

#include <algorithm>

#include "bench/study/common_pixels.h"
#include "bench/study/compare.h"
#include "bench/study/study_benches.h"
#include "bench/study/study_tables.h"

namespace skyquilt::bench {
namespace {

struct Baseline {
  const char* encoding;
  const char* label;
};

constexpr Baseline kBaselines[] = {
    {"hash", "hash grid (Instant-NGP)"},
    {"voxels", "dense voxels (DVGO)"},
    {"planes", "planes and lines (TensoRF)"},
    {"frequency", "sines and cosines (NeRF)"},
};

}  // namespace

StudyBench EncodingsBench(Study& study, const EncodingsOptions& options) {
  StudyBench bench;
  const config::Override budget = {"run.time_budget_s", fmt::format("{}", options.budget_s)};
  for (const Baseline& baseline : kBaselines) {
    std::vector<config::Override> overrides = {budget, {"train.encoding", baseline.encoding}, {"context.encoding", baseline.encoding}};
    if (std::string(baseline.encoding) == "frequency") {
      // Without tables the networks must store the whole scene, so they are larger.
      for (const char* section : {"train", "context"}) {
        overrides.push_back({std::string(section) + ".hidden", std::to_string(options.frequency_hidden)});
        overrides.push_back({std::string(section) + ".density_hidden_layers", std::to_string(options.frequency_layers)});
        overrides.push_back({std::string(section) + ".learning_rate", fmt::format("{}", options.frequency_learning_rate)});
      }
    }
    bench.results.push_back(study.Run({.name = baseline.encoding, .label = baseline.label, .overrides = std::move(overrides)}));
  }
  ScoreCommonPixels(study.folder(), PointersTo(bench.results));
  BenchPage& page = bench.page;
  page.name = "encodings";
  page.title = "Encodings of position";
  page.lead = fmt::format(
      "The same field with four encodings of position, {:.0f} s of training each, with the same losses, sampling and occupancy grid. Voxels and "
      "planes "
      "have about as many parameters as the hash grid. Sines and cosines have none; their network has {} layers of width {} instead.",
      options.budget_s, options.frequency_layers, options.frequency_hidden);
  const VariantResult& hash = bench.results.front();
  for (size_t i = 1; i < bench.results.size(); ++i) {
    const VariantResult& other = bench.results[i];
    if (!hash.failure.empty() || !other.failure.empty()) continue;
    const Difference difference = PsnrDifference(other, hash);
    const std::vector<double> psnr_db = ComparablePsnr({&other, &hash});
    page.figures.push_back(DifferenceFigure(other.label, difference, "against the hash grid"));
    page.verdicts.push_back(
        fmt::format("{} against the hash grid: {}, {:.2f} against {:.2f} dB, with {:.0f} % of its parameters at {:.0f} % of its samples per second.",
                    other.label, Shown(difference), psnr_db[0], psnr_db[1], 100.0 * other.parameters / hash.parameters,
                    100.0 * other.samples_per_second / hash.samples_per_second));
  }
  page.sections.push_back({.id = "quality",
                           .title = "Quality, time, memory",
                           .lead = "",
                           .charts = {TrainingChart(bench.results)},
                           .tables = {QualityTable(bench.results)},
                           .pictures = {}});
  page.sections.push_back(PictureSection(bench.results));
  return bench;
}

}  // namespace skyquilt::bench
