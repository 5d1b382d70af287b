#include "bench/study/study_tables.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "core/page/curve_chart.h"

namespace skyquilt::bench {
namespace {

double SamplesPerRay(const VariantResult& r) {
  int64_t samples = 0, rays = 0;
  for (const VariantField& field : r.fields) {
    samples += field.samples;
    rays += field.rays;
  }
  return rays > 0 ? static_cast<double>(samples) / static_cast<double>(rays) : VariantResult::kNone;
}

struct Column {
  const char* title;
  std::function<BenchCell(const VariantResult&)> cell;
};

const std::vector<Column>& Columns() {
  static const std::vector<Column> kColumns = {
      {"PSNR", [](const VariantResult& r) { return BenchCell::Number(r.psnr_db, 2, "dB"); }},
      {"PSNR, common", [](const VariantResult& r) { return BenchCell::Number(r.psnr_common_db, 2, "dB"); }},
      {"SSIM", [](const VariantResult& r) { return BenchCell::Number(r.ssim, 3); }},
      {"FLIP", [](const VariantResult& r) { return BenchCell::Number(r.flip, 3); }},
      {"LPIPS", [](const VariantResult& r) { return BenchCell::Number(r.lpips, 3); }},
      {"full frame", [](const VariantResult& r) { return BenchCell::Number(r.psnr_full_db, 2, "dB"); }},
      {"depth, median", [](const VariantResult& r) { return BenchCell::Number(r.depth_median_abs_m, 2, "m"); }},
      {"depth, RMSE", [](const VariantResult& r) { return BenchCell::Number(r.depth_rmse_m, 2, "m"); }},
      {"kept points, NMAD", [](const VariantResult& r) { return BenchCell::Number(r.kept_nmad_gsd, 2, "GSD"); }},
      {"floater opacity", [](const VariantResult& r) { return BenchCell::Percent(r.floater_opacity, 2); }},
      {"training", [](const VariantResult& r) { return BenchCell::Seconds(r.train_seconds); }},
      {"samples", [](const VariantResult& r) { return BenchCell::Count(r.samples); }},
      {"samples per ray", [](const VariantResult& r) { return BenchCell::Number(SamplesPerRay(r), 1); }},
      {"samples/s", [](const VariantResult& r) { return BenchCell::Count(r.samples_per_second); }},
      {"memory", [](const VariantResult& r) { return BenchCell::Bytes(r.peak_rss_bytes); }},
      {"parameters", [](const VariantResult& r) { return BenchCell::Count(r.parameters); }},
      {"in the scene", [](const VariantResult& r) { return BenchCell::Count(r.scene_parameters); }},
      {"scene file", [](const VariantResult& r) { return BenchCell::Bytes(r.scene_bytes); }},
      {"evaluation", [](const VariantResult& r) { return BenchCell::Seconds(r.evaluate_seconds); }},
  };
  return kColumns;
}

nlohmann::ordered_json JsonOf(const VariantResult& result) {
  nlohmann::ordered_json json = base::ParseOrderedJson(ResultJson(result, ""));
  json.erase("identity");
  for (const VariantResult& seed : result.seeds) json["seeds"].push_back(JsonOf(seed));
  return json;
}

}  // namespace

BenchTable QualityTable(const std::vector<VariantResult>& results, const std::string& name) {
  BenchTable table{
      .name = name,
      .title = "",
      .note =
          "PSNR, SSIM and FLIP over the pixels of held-out photos that at least two training photos see; common: over those where this is so for all "
          "variants that are compared. Memory is the peak during training.",
      .columns = {"variant"},
      .rows = {}};
  if (!results.empty() && !results.front().seeds.empty()) table.note += fmt::format(" Medians over {} seeds.", results.front().seeds.size());
  for (const VariantResult& r : results) table.rows.push_back({BenchCell::Text(r.failure.empty() ? r.label : r.label + " (" + r.failure + ")")});
  for (const Column& column : Columns()) {
    if (std::all_of(results.begin(), results.end(), [&](const VariantResult& r) { return std::isnan(column.cell(r).value); })) continue;
    table.columns.emplace_back(column.title);
    for (size_t i = 0; i < results.size(); ++i) table.rows[i].push_back(column.cell(results[i]));
  }
  return table;
}

BenchTable BlockTable(const std::vector<VariantResult>& results, const std::string& name) {
  BenchTable table{.name = name, .title = "Held-out PSNR per block", .note = "", .columns = {"block"}, .rows = {}};
  std::vector<const VariantResult*> divided;
  std::vector<std::string> blocks;
  for (const VariantResult& r : results) {
    if (r.blocks < 2) continue;
    divided.push_back(&r);
    table.columns.push_back(r.label);
    for (const VariantField& field : r.fields) {
      if (field.name != "context" && std::find(blocks.begin(), blocks.end(), field.name) == blocks.end()) blocks.push_back(field.name);
    }
  }
  std::sort(blocks.begin(), blocks.end());
  for (const std::string& block : blocks) {
    std::vector<BenchCell> row = {BenchCell::Text(block)};
    for (const VariantResult* r : divided) {
      const auto field = std::find_if(r->fields.begin(), r->fields.end(), [&](const VariantField& f) { return f.name == block; });
      row.push_back(BenchCell::Number(field == r->fields.end() ? VariantResult::kNone : field->psnr_db, 2, "dB"));
    }
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::string TrainingChart(const std::vector<VariantResult>& results) {
  std::vector<page::Curve> curves;
  curves.reserve(results.size());
  for (const VariantResult& r : results) curves.push_back({.name = r.label, .points = r.curve});
  return page::CurveChart(
      curves,
      {.title = "PSNR of the training batches, mean over blocks", .x_label = "training time of all blocks together (s)", .y_label = "PSNR (dB)"});
}

BenchSection PictureSection(const std::vector<VariantResult>& results) {
  BenchSection section{.id = "pictures",
                       .title = "Images",
                       .lead =
                           "The same held-out photo and its rendering by every variant, magnified. Move the pointer to see another part "
                           "in all of them; click to see the whole image.",
                       .charts = {},
                       .tables = {},
                       .pictures = {}};
  for (const VariantResult& r : results) {
    if (r.render.empty()) continue;
    if (section.pictures.empty()) section.pictures.push_back({r.photo, "photo"});
    section.pictures.push_back({r.render, r.label});
  }
  return section;
}

std::string NumberInName(double number) {
  std::string name = fmt::format("{:g}", number);
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

std::string Signed(double number, int decimals) {
  const std::string text = fmt::format("{:+.{}f}", number, decimals);
  return text.find_first_of("123456789") == std::string::npos && std::isfinite(number) ? text.substr(1) : text;
}

std::string OfItsOwn(const VariantResult& result) {
  std::vector<double> seconds, samples;
  for (const VariantField& field : result.fields) {
    if (field.name == "context") continue;
    seconds.push_back(field.seconds);
    samples.push_back(static_cast<double>(field.samples) / 1e6);
  }
  if (seconds.empty()) return "nothing";
  const auto range = [](const std::vector<double>& of) {
    const auto [low, high] = std::minmax_element(of.begin(), of.end());
    return of.size() == 1 ? fmt::format("{:.0f}", *low) : fmt::format("{:.0f} to {:.0f}", *low, *high);
  };
  return range(seconds) + " s and " + range(samples) + " M samples";
}

std::string StudyJson(const BenchPage& page, const std::vector<VariantResult>& results, const std::string& settings_toml) {
  nlohmann::ordered_json json;
  json["bench"] = page.name;
  json["verdicts"] = page.verdicts;
  json["results"] = nlohmann::ordered_json::array();
  for (const VariantResult& r : results) json["results"].push_back(JsonOf(r));
  json["settings"] = settings_toml;
  json["command"] = page.command;
  json["machine"] = page.machine;
  json["date"] = page.date;
  return base::JsonText(json, 2) + "\n";
}

}  // namespace skyquilt::bench
