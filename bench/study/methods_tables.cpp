#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "bench/study/compare.h"
#include "bench/study/methods_parts.h"
#include "bench/study/study_tables.h"
#include "core/page/bar_chart.h"

namespace skyquilt::bench {
namespace {

// A failed training is told beside the name.
BenchCell NameCell(const MethodPair& pair) {
  std::string text = pair.name;
  if (!pair.one.failure.empty()) text += " (one field: " + pair.one.failure + ")";
  if (!pair.blocks.failure.empty()) text += " (blocks: " + pair.blocks.failure + ")";
  return BenchCell::Text(text);
}

// The PSNR of all trainings that is compared, one field and blocks of each pair in turn.
std::vector<double> PsnrOf(const std::vector<MethodPair>& pairs) {
  std::vector<const VariantResult*> results;
  for (const MethodPair& pair : pairs) {
    results.push_back(&pair.one);
    results.push_back(&pair.blocks);
  }
  return ComparablePsnr(results);
}

BenchCell DifferenceCell(const Difference& difference) {
  BenchCell cell = BenchCell::Number(difference.median, 2, "dB");
  if (difference.pairs > 0) cell.shown = Signed(difference.median, 2) + " dB" + (difference.seen ? "" : " (not seen)");
  return cell;
}

}  // namespace

double MeanSteps(const VariantResult& result) {
  double steps = 0.0, fields = 0.0;
  for (const VariantField& field : result.fields) {
    if (field.name == "context") continue;
    steps += static_cast<double>(field.steps);
    fields += 1.0;
  }
  return fields > 0.0 ? steps / fields : VariantResult::kNone;
}

double PhotoPasses(const VariantResult& result, double training_pixels) {
  double rays = 0.0;
  for (const VariantField& field : result.fields) rays += static_cast<double>(field.rays);
  return rays > 0.0 && training_pixels > 0.0 ? rays / training_pixels : VariantResult::kNone;
}

double TrainingPixels(const survey::Survey& survey, int image_width) {
  double pixels = 0.0;
  for (const survey::Photo& photo : survey.photos) {
    const camera::Camera& camera = survey.cameras[static_cast<size_t>(photo.camera)];
    if (photo.is_test || camera.width <= 0) continue;
    const double scale = image_width > 0 ? std::min(1.0, static_cast<double>(image_width) / camera.width) : 1.0;
    pixels += scale * camera.width * scale * camera.height;
  }
  return pixels;
}

std::vector<SurveyCondition> SurveyConditions(const std::vector<double>& overlaps, const std::vector<double>& altitudes_m) {
  std::vector<SurveyCondition> conditions = {{}};
  // Every condition so far with every value.
  const auto multiply = [&conditions](const std::vector<double>& values, const auto& change) {
    if (values.empty()) return;
    std::vector<SurveyCondition> all;
    for (const SurveyCondition& before : conditions) {
      for (const double value : values) {
        all.push_back(before);
        if (!before.label.empty()) {
          all.back().suffix += "_";
          all.back().label += ", ";
        }
        change(value, &all.back());
      }
    }
    conditions = std::move(all);
  };
  multiply(overlaps, [](double overlap, SurveyCondition* condition) {
    condition->suffix += "o" + NumberInName(100.0 * overlap);
    condition->label += fmt::format("overlap {:g} %", 100.0 * overlap);
    for (const char* key : {"simulate.forward_overlap", "simulate.side_overlap"}) condition->overrides.push_back({key, fmt::format("{}", overlap)});
  });
  multiply(altitudes_m, [](double altitude_m, SurveyCondition* condition) {
    condition->suffix += "a" + NumberInName(altitude_m);
    condition->label += fmt::format("{:g} m", altitude_m);
    condition->overrides.push_back({"simulate.altitudes", fmt::format("{}", altitude_m)});
  });
  return conditions;
}

BenchTable MethodTable(const std::vector<MethodPair>& pairs, bool networks, const std::string& name) {
  BenchTable table{
      .name = name,
      .title = networks ? "Networks of NeRF's size" : "Fields with tables",
      .note = "",
      .columns = {"method", "PSNR, one field", "PSNR, blocks", "blocks - one", "SSIM, one field", "SSIM, blocks", "FLIP, one field", "FLIP, blocks"},
      .rows = {}};
  if (!networks) {
    table.note = "PSNR over the pixels of held-out photos that all trainings score. (not seen): no larger than the noise of such trainings.";
  }
  const bool lpips = std::any_of(pairs.begin(), pairs.end(), [](const MethodPair& pair) { return std::isfinite(pair.one.lpips); });
  if (lpips) table.columns.insert(table.columns.end(), {"LPIPS, one field", "LPIPS, blocks"});
  const std::vector<double> psnr_db = PsnrOf(pairs);
  for (size_t i = 0; i < pairs.size(); ++i) {
    const MethodPair& pair = pairs[i];
    if (pair.network != networks) continue;
    std::vector<BenchCell> row = {NameCell(pair), BenchCell::Number(psnr_db[2 * i], 2, "dB"), BenchCell::Number(psnr_db[2 * i + 1], 2, "dB"),
                                  DifferenceCell(PsnrDifference(pair.blocks, pair.one))};
    for (const auto score : {&VariantResult::ssim, &VariantResult::flip, &VariantResult::lpips}) {
      if (score == &VariantResult::lpips && !lpips) continue;
      row.push_back(BenchCell::Number(pair.one.*score, 3));
      row.push_back(BenchCell::Number(pair.blocks.*score, 3));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

BenchTable NetworkStepsTable(const std::vector<MethodPair>& pairs, double training_pixels, const std::string& name) {
  BenchTable table{.name = name,
                   .title = "Steps of the networks, here and in their papers",
                   .note =
                       "A pass is as many rays as the training photos have pixels. Passes of the papers are those of their steps and rays over the "
                       "photos of this survey.",
                   .columns = {"method", "steps, one field", "steps per block", "passes, one field", "passes, blocks", "paper: steps",
                               "rays per step", "passes", "source"},
                   .rows = {}};
  for (const PublishedTraining& published : PublishedTrainings()) {
    const auto pair = std::find_if(pairs.begin(), pairs.end(), [&published](const MethodPair& p) { return p.name == published.name; });
    if (pair == pairs.end()) continue;
    BenchCell steps = BenchCell::Count(published.fewest_steps);
    if (published.most_steps > published.fewest_steps) steps.shown += " to " + BenchCell::Count(published.most_steps).shown;
    table.rows.push_back({BenchCell::Text(pair->name), BenchCell::Number(MeanSteps(pair->one), 0), BenchCell::Number(MeanSteps(pair->blocks), 0),
                          BenchCell::Number(PhotoPasses(pair->one, training_pixels), 2),
                          BenchCell::Number(PhotoPasses(pair->blocks, training_pixels), 2), steps, BenchCell::Number(published.rays_per_step, 0),
                          BenchCell::Number(published.fewest_steps * published.rays_per_step / training_pixels, 0),
                          BenchCell::Text(published.source)});
  }
  return table;
}

BenchTable MatrixCityTable(const std::vector<MethodPair>& pairs, const std::string& name) {
  BenchTable table{
      .name = name,
      .title = "",
      .note =
          "Published, SSIM and LPIPS: Li et al. 2023, supplement, table 2, Small City from the air, one model against five, trained on GPUs "
          "until they converge, on other photos than these. So orders can be compared, numbers cannot.",
      .columns = {"method", "one field", "blocks", "published, one", "published, five", "five - one", "SSIM, one", "SSIM, five", "LPIPS, one",
                  "LPIPS, five"},
      .rows = {}};
  const std::vector<double> psnr_db = PsnrOf(pairs);
  for (const PublishedMethod& published : MatrixCityScores()) {
    const auto pair = std::find_if(pairs.begin(), pairs.end(), [&published](const MethodPair& p) { return p.name == published.name; });
    const auto i = static_cast<size_t>(pair - pairs.begin());
    const double one_db = pair == pairs.end() ? VariantResult::kNone : psnr_db[2 * i];
    const double blocks_db = pair == pairs.end() ? VariantResult::kNone : psnr_db[2 * i + 1];
    BenchCell gain = BenchCell::Number(published.several.psnr_db - published.one.psnr_db, 2, "dB");
    gain.shown = Signed(gain.value, 2) + " dB";
    table.rows.push_back({BenchCell::Text(published.name), BenchCell::Number(one_db, 2, "dB"), BenchCell::Number(blocks_db, 2, "dB"),
                          BenchCell::Number(published.one.psnr_db, 2, "dB"), BenchCell::Number(published.several.psnr_db, 2, "dB"), gain,
                          BenchCell::Number(published.one.ssim, 3), BenchCell::Number(published.several.ssim, 3),
                          BenchCell::Number(published.one.lpips, 3), BenchCell::Number(published.several.lpips, 3)});
  }
  return table;
}

std::string MethodChart(const std::vector<MethodPair>& pairs) {
  std::vector<page::Bar> bars;
  const std::vector<double> psnr_db = PsnrOf(pairs);
  for (size_t i = 0; i < pairs.size(); ++i) {
    const double one_db = psnr_db[2 * i], blocks_db = psnr_db[2 * i + 1];
    bars.push_back({.label = pairs[i].name,
                    .value = blocks_db,
                    .shown = std::isfinite(blocks_db) ? fmt::format("{:.2f} dB", blocks_db) : "",
                    .limit = one_db,
                    .limit_shown = fmt::format("{:.2f} dB", one_db)});
  }
  return page::BarChart(bars, {.title = "PSNR of held-out photos", .x_label = "PSNR (dB)", .value_name = "blocks", .limit_name = "one field"});
}

BenchTable GroundTable(const std::vector<MethodPair>& pairs, const std::vector<std::string>& blocks, const std::vector<std::vector<double>>& psnr_db,
                       const std::string& name) {
  BenchTable table{
      .name = name,
      .title = "PSNR on the ground of each block",
      .note =
          "Over the pixels of held-out photos that all trainings score, by the place where their rays reach level ground; of several seeds "
          "the first.",
      .columns = {"method", "block", "one field", "blocks", "blocks - one"},
      .rows = {}};
  for (size_t i = 0; i < pairs.size(); ++i) {
    for (size_t b = 0; b < blocks.size(); ++b) {
      const double one_db = psnr_db[2 * i][b], blocks_db = psnr_db[2 * i + 1][b];
      BenchCell gain = BenchCell::Number(blocks_db - one_db, 2, "dB");
      if (std::isfinite(gain.value)) gain.shown = Signed(gain.value, 2) + " dB";
      table.rows.push_back({BenchCell::Text(pairs[i].name), BenchCell::Text(blocks[b]), BenchCell::Number(one_db, 2, "dB"),
                            BenchCell::Number(blocks_db, 2, "dB"), gain});
    }
  }
  return table;
}

}  // namespace skyquilt::bench
