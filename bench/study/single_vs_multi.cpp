#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/study/common_pixels.h"
#include "bench/study/compare.h"
#include "bench/study/joined_tables.h"
#include "bench/study/study_benches.h"
#include "bench/study/study_tables.h"
#include "core/page/curve_chart.h"

namespace skyquilt::bench {
namespace {

const VariantResult* Find(const std::vector<VariantResult>& results, const std::string& name) {
  const auto at = std::find_if(results.begin(), results.end(), [&](const VariantResult& r) { return r.name == name && r.failure.empty(); });
  return at == results.end() ? nullptr : &*at;
}

std::string Against(const VariantResult& a, const VariantResult& b) {
  const std::vector<double> psnr_db = ComparablePsnr({&a, &b});
  return fmt::format("{}, {:.2f} against {:.2f} dB, SSIM {}", Shown(PsnrDifference(a, b)), psnr_db[0], psnr_db[1], Signed(a.ssim - b.ssim, 3));
}

// Opacity this far in front of surfaces comes from floaters, not from blurred surfaces.
constexpr double kHighFloaters_m = 10.0;

double HighFloaters(const VariantResult& result) {
  for (const auto& [clearance_m, opacity] : result.floater_profile) {
    if (clearance_m == kHighFloaters_m) return opacity;
  }
  return VariantResult::kNone;
}

// How many times as much floater opacity `b` has as `a`; empty without measurements.
std::string FloaterRatio(const VariantResult& a, const VariantResult& b) {
  std::string text;
  const auto add = [&text](const std::string& what, double less, double more) {
    if (!std::isfinite(less) || !std::isfinite(more) || !(less > 0.0)) return;
    text += fmt::format("; {} {:.3f} % against {:.3f} %, a factor of {:.1f}", what, 100.0 * less, 100.0 * more, more / less);
  };
  add("floater opacity", a.floater_opacity, b.floater_opacity);
  add(fmt::format("{:g} m and more in front of surfaces", kHighFloaters_m), HighFloaters(a), HighFloaters(b));
  return text;
}

BenchSection FloaterSection(const std::vector<VariantResult>& results) {
  std::vector<page::Curve> curves;
  curves.reserve(results.size());
  for (const VariantResult& r : results) curves.push_back({.name = r.label, .points = r.floater_profile, .marks = true});
  return {.id = "floaters",
          .title = "Floater opacity",
          .lead =
              "Opacity of a ray from the camera up to the given distance in front of the true surface, where space should be free. Blurred "
              "surfaces reach a few metres; opacity beyond that comes from floaters.",
          .charts = {page::CurveChart(curves, {.title = "Opacity in front of surfaces",
                                               .x_label = "distance from the true surface (m)",
                                               .y_label = "opacity",
                                               .log_y = true,
                                               .log_x = true})},
          .tables = {},
          .pictures = {}};
}

std::vector<std::string> Verdicts(const std::vector<VariantResult>& results) {
  const VariantResult* guided = Find(results, "guided");
  const VariantResult* small = Find(results, "single_small");
  const VariantResult* large = Find(results, "single_large");
  const VariantResult* independent = Find(results, "independent");
  const VariantResult* shared = Find(results, "shared_height");
  const VariantResult* everywhere = Find(results, "everywhere");
  const VariantResult* shared_everywhere = Find(results, "shared_everywhere");
  std::vector<std::string> verdicts;
  if (guided == nullptr) return {"The model with several blocks could not be trained, so nothing can be compared."};
  if (small != nullptr) {
    verdicts.push_back("Blocks against one model with the table size of one block, equal time: " + Against(*guided, *small) + ".");
  }
  if (large != nullptr) {
    verdicts.push_back(fmt::format("Blocks against one model with as many parameters ({:.1f} M against {:.1f} M), equal time: {}.",
                                   guided->parameters / 1e6, large->parameters / 1e6, Against(*guided, *large)));
    verdicts.push_back(
        fmt::format("The large model was trained with {:.0f} M samples ({:.2f} M/s), the blocks with {:.0f} M together ({:.2f} M/s){}.",
                    large->samples / 1e6, large->samples_per_second / 1e6, guided->samples / 1e6, guided->samples_per_second / 1e6,
                    large->samples_per_second < 0.95 * guided->samples_per_second ? ": larger tables do not fit into the caches" : ""));
    verdicts.push_back(fmt::format("Each block was trained with {}, the large model with {}.", OfItsOwn(*guided), OfItsOwn(*large)));
  }
  if (independent != nullptr)
    verdicts.push_back("Blocks with the context (guided) against blocks without it: " + Against(*guided, *independent) + ".");
  if (shared != nullptr) {
    verdicts.push_back("Boxes as high as their content against boxes with the height of the whole survey: " + Against(*guided, *shared) +
                       FloaterRatio(*guided, *shared) + ".");
  }
  if (everywhere != nullptr && shared_everywhere != nullptr) {
    verdicts.push_back("The same when training starts in the whole box (train.start = everywhere): " + Against(*everywhere, *shared_everywhere) +
                       FloaterRatio(*everywhere, *shared_everywhere) + ".");
  }
  if (shared_everywhere != nullptr) {
    verdicts.push_back("Boxes as high as their content and training that starts at known surfaces, against neither: " +
                       Against(*guided, *shared_everywhere) + FloaterRatio(*guided, *shared_everywhere) + ".");
  }
  for (const VariantResult* one : {small, large}) {
    if (one == nullptr || !std::isfinite(one->floater_opacity) || !(guided->floater_opacity > 0.0)) continue;
    verdicts.push_back(fmt::format("Floater opacity of '{}': {:.3f} %, {:.1f} times that of the blocks.", one->label, 100.0 * one->floater_opacity,
                                   one->floater_opacity / guided->floater_opacity));
  }
  return verdicts;
}

}  // namespace

StudyBench SingleVsMulti(Study& study, const SingleVsMultiOptions& options) {
  StudyBench bench;
  std::vector<VariantResult>& results = bench.results;
  const config::Override budget = {"run.time_budget_s", fmt::format("{}", options.budget_s)};
  const auto run = [&](const std::string& name, const std::string& label, std::vector<config::Override> overrides) {
    overrides.push_back(budget);
    results.push_back(study.Run({.name = name, .label = label, .overrides = std::move(overrides)}));
  };
  const config::Override divided = {"partition.blocks", options.blocks}, whole = {"partition.blocks", "1x1"};
  run("guided", "blocks, guided", {divided});
  const std::string joined = std::to_string(JoinedTableSize(results.front(), study.settings().partition.max_log2_table_size));
  run("single_small", "single, tables of one block", {whole});
  run("single_large", "single, as many parameters", {whole, {"partition.min_log2_table_size", joined}, {"partition.max_log2_table_size", joined}});
  run("independent", "blocks, independent", {divided, {"train.coupling", "independent"}});
  const config::Override one_height = {"partition.heights", "survey"}, everywhere = {"train.start", "everywhere"};
  const config::Override same_context = {"context.start", study.settings().context.start};
  run("shared_height", "blocks, one height for all", {divided, one_height});
  // Floater opacity can only be measured when the true surface is known.
  if (std::isfinite(results.front().floater_opacity)) {
    run("everywhere", "blocks, start in the whole box", {divided, everywhere, same_context});
    run("shared_everywhere", "one height for all, start in the whole box", {divided, one_height, everywhere, same_context});
  }
  ScoreCommonPixels(study.folder(), PointersTo(results));

  BenchPage& page = bench.page;
  page.name = "single-vs-multi";
  page.title = "One model or many";
  page.lead = fmt::format(
      "Compares one field of the whole area with one field per block, for the same survey and the same {:.0f} s of training (context included). "
      "Blocks are trained with the context (guided) or without it (independent). Floater opacity is the opacity of a ray from the camera to 1 m in "
      "front of the true surface; it is known only for simulated surveys.",
      options.budget_s);
  if (const VariantResult* guided = Find(results, "guided")) {
    page.figures.push_back({"Blocks, guided", fmt::format("{:.2f} dB", guided->psnr_db), fmt::format("{} blocks", guided->blocks)});
    if (const VariantResult* small = Find(results, "single_small")) {
      page.figures.push_back(DifferenceFigure("against one such model", PsnrDifference(*guided, *small), "equal time"));
    }
    if (const VariantResult* large = Find(results, "single_large")) {
      page.figures.push_back(DifferenceFigure("against one as large as all", PsnrDifference(*guided, *large), "equal time and parameters"));
    }
    if (const VariantResult* naive = Find(results, "shared_everywhere"); naive != nullptr && HighFloaters(*guided) > 0.0) {
      page.figures.push_back({"Floaters high above surfaces", fmt::format("{:.1f} x less", HighFloaters(*naive) / HighFloaters(*guided)),
                              "boxes as high as their content, start at known surfaces"});
    }
  }
  page.verdicts = Verdicts(results);
  page.sections.push_back(
      {.id = "quality", .title = "Quality, time, memory", .lead = "", .charts = {}, .tables = {QualityTable(results)}, .pictures = {}});
  page.sections.push_back({.id = "blocks",
                           .title = "Block by block",
                           .lead = "",
                           .charts = {TrainingChart(results)},
                           .tables = {BlockTable(results, "blocks")},
                           .pictures = {}});
  if (!results.front().floater_profile.empty()) page.sections.push_back(FloaterSection(results));
  page.sections.push_back(PictureSection(results));
  return bench;
}

}  // namespace skyquilt::bench
