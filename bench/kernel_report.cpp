#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "bench/kernel_bench.h"
#include "core/base/json_text.h"
#include "core/base/system.h"
#include "core/page/bar_chart.h"
#include "core/page/html.h"

namespace skyquilt::bench {
namespace {

using Json = nlohmann::ordered_json;

Json SpeedJson(const KernelSpeed& s) {
  Json share;
  for (size_t i = 0; i < worker::kPhases; ++i) {
    if (s.train_share[i] > 0.0) share[worker::kPhaseNames[i]] = s.train_share[i];
  }
  share["waiting"] = s.waiting_share;
  return {{"threads", s.threads},
          {"train_samples_per_second", s.train_samples_per_second},
          {"infer_samples_per_second", s.infer_samples_per_second},
          {"roofline_train_samples_per_second", s.roofline_train_samples_per_second},
          {"roofline_infer_samples_per_second", s.roofline_infer_samples_per_second},
          {"roofline_fraction", s.RooflineFraction()},
          {"peak_gflops_per_thread", s.gflops_per_thread},
          {"limit_ns_per_sample_and_thread",
           {{"networks", 1e9 * s.network_limit_s}, {"random_reads", 1e9 * s.gather_limit_s}, {"random_additions", 1e9 * s.scatter_limit_s}}},
          {"share", share}};
}

std::string Million(double value) {
  return fmt::format("{:.2f} M/s", value * 1e-6);
}

std::string InMillions(double samples_per_second) {
  return page::FormatFixed(samples_per_second * 1e-6, 2, "M/s");
}

BenchCell RateCell(double samples_per_second) {
  return {InMillions(samples_per_second), samples_per_second};
}

// Shown and stored in nanoseconds.
BenchCell NsCell(double seconds) {
  return BenchCell::Number(1e9 * seconds, 1, "ns");
}

std::string ThreadsText(int threads) {
  return threads == 1 ? "one thread" : fmt::format("{} threads", threads);
}

// Speeds with all threads, and with one thread if that was measured too.
std::vector<KernelSpeed> SpeedsOf(const KernelBenchResult& r) {
  std::vector<KernelSpeed> speeds = {r.all};
  speeds.insert(speeds.end(), r.one_thread.begin(), r.one_thread.end());
  return speeds;
}

std::vector<BenchFigure> KernelFigures(const KernelBenchResult& r) {
  const KernelSpeed& s = r.all;
  std::vector<BenchFigure> figures = {
      {"Training", InMillions(s.train_samples_per_second), fmt::format("samples on {}, {}", ThreadsText(s.threads), r.isa)},
      {"Share of the limit", page::FormatPercent(s.RooflineFraction(), 0),
       "limit of this machine: " + InMillions(s.roofline_train_samples_per_second)},
      {"Inference", InMillions(s.infer_samples_per_second),
       fmt::format("{} times training; limit {}", page::FormatFixed(s.infer_samples_per_second / s.train_samples_per_second, 1),
                   InMillions(s.roofline_infer_samples_per_second))}};
  if (!r.one_thread.empty()) {
    const KernelSpeed& one = r.one_thread.front();
    figures.push_back(
        {"One thread trains", InMillions(one.train_samples_per_second), page::FormatPercent(one.RooflineFraction(), 0) + " of its own limit"});
    figures.push_back({"Scaling", page::FormatPercent(r.ScalingFraction(), 0),
                       fmt::format("speed-up by {}, as a fraction of the limit's speed-up", ThreadsText(s.threads))});
  }
  return figures;
}

std::vector<std::string> KernelVerdicts(const KernelBenchResult& r) {
  const KernelSpeed& s = r.all;
  const auto most = static_cast<size_t>(std::max_element(s.train_share.begin(), s.train_share.end()) - s.train_share.begin());
  std::vector<std::string> verdicts = {fmt::format("Training reaches {} of this machine's limit. The longest phase is {} ({} of the time).",
                                                   page::FormatPercent(s.RooflineFraction(), 0), worker::kPhaseNames[most],
                                                   page::FormatPercent(s.train_share[most], 0))};
  if (!r.one_thread.empty()) {
    const KernelSpeed& one = r.one_thread.front();
    verdicts.push_back(fmt::format("{} threads train {} times as fast as one thread; the limit is {} times as high.", s.threads,
                                   page::FormatFixed(s.train_samples_per_second / one.train_samples_per_second, 2),
                                   page::FormatFixed(s.roofline_train_samples_per_second / one.roofline_train_samples_per_second, 2)));
  }
  return verdicts;
}

BenchSection LimitSection(const KernelBenchResult& r) {
  BenchTable table{
      .name = "limit", .title = "", .note = "", .columns = {"samples per second", "measured", "limit", "share of the limit"}, .rows = {}};
  std::vector<page::Bar> bars;
  const auto add = [&](const std::string& what, double measured, double limit) {
    table.rows.push_back({BenchCell::Text(what), RateCell(measured), RateCell(limit), BenchCell::Percent(measured / limit)});
    bars.push_back({.label = what, .value = 1e-6 * measured, .shown = InMillions(measured), .limit = 1e-6 * limit, .limit_shown = InMillions(limit)});
  };
  for (const KernelSpeed& s : SpeedsOf(r)) {
    add("training, " + ThreadsText(s.threads), s.train_samples_per_second, s.roofline_train_samples_per_second);
    add("inference, " + ThreadsText(s.threads), s.infer_samples_per_second, s.roofline_infer_samples_per_second);
  }
  return {.id = "limit",
          .title = "Against the limit",
          .lead =
              "The limit counts only the multiply-adds of a sample at the peak rate, and its random reads and additions in the tables, one after "
              "the other.",
          .charts = {page::BarChart(bars, {.title = "Measured against the limit", .x_label = "million samples per second"})},
          .tables = {table},
          .pictures = {}};
}

BenchSection PhaseSection(const KernelBenchResult& r) {
  const std::vector<KernelSpeed> speeds = SpeedsOf(r);
  BenchTable table{.name = "phases", .title = "", .note = "", .columns = {"phase"}, .rows = {}};
  for (const KernelSpeed& s : speeds) {
    table.columns.push_back("share, " + ThreadsText(s.threads));
    table.columns.push_back("ns per sample, " + ThreadsText(s.threads));
  }
  std::vector<std::vector<page::Bar>> bars(speeds.size());
  for (size_t phase = 0; phase <= worker::kPhases; ++phase) {
    const bool waiting = phase == worker::kPhases;
    if (!waiting && !(r.all.train_share[phase] > 0.0)) continue;
    const std::string name = waiting ? "waiting, bookkeeping" : worker::kPhaseNames[phase];
    std::vector<BenchCell> row = {BenchCell::Text(name)};
    for (size_t k = 0; k < speeds.size(); ++k) {
      const KernelSpeed& s = speeds[k];
      const double share = waiting ? s.waiting_share : s.train_share[phase];
      row.push_back(BenchCell::Percent(share));
      bars[k].push_back({.label = name, .value = 100.0 * share, .shown = row.back().shown});
      row.push_back(NsCell(share * s.threads / s.train_samples_per_second));
      bars[k].back().shown += " \xC2\xB7 " + row.back().shown;
    }
    table.rows.push_back(row);
  }
  std::vector<std::string> charts;
  for (size_t k = 0; k < speeds.size(); ++k) {
    charts.push_back(
        page::BarChart(bars[k], {.title = "Training on " + ThreadsText(speeds[k].threads), .x_label = "share of the threads' time (%)"}));
  }
  return {.id = "phases",
          .title = "Time per training phase",
          .lead = "Time of one thread for one training sample. Waiting is the time outside all phases: idle threads and the work between phases.",
          .charts = charts,
          .tables = {table},
          .pictures = {}};
}

std::string PassesText(const SamplerSpeed& s) {
  return fmt::format("{}", fmt::join(s.samples, " + "));
}

// The field itself sees the last of the samples.
BenchSection SamplerSection(const KernelBenchResult& r) {
  BenchTable table{.name = "samplers",
                   .title = "",
                   .note = "",
                   .columns = {"sampler", "samples per pass", "rays placed", "rays learned", "share of a step's time"},
                   .rows = {}};
  for (const SamplerSpeed& s : r.samplers) {
    const double learn_s = s.learn_rays_per_second > 0.0 ? 1.0 / s.learn_rays_per_second : 0.0;
    const double sampler_s = 1.0 / s.place_rays_per_second + learn_s;
    const double field_s = s.field_samples / r.all.train_samples_per_second;
    const auto rate = [](double rays) { return BenchCell{page::FormatFixed(1e-3 * rays, 0, "k/s"), rays}; };
    table.rows.push_back({BenchCell::Text(s.sampler), BenchCell::Text(PassesText(s)), rate(s.place_rays_per_second),
                          learn_s > 0.0 ? rate(s.learn_rays_per_second) : BenchCell::Text(""),
                          BenchCell::Percent(sampler_s / (sampler_s + field_s))});
  }
  return {.id = "samplers",
          .title = "Samplers beside the occupancy grid",
          .lead =
              "Rays whose samples are placed by passes of their own, on all threads, and of proposals those from which they learn. The last pass is "
              "the field's. The share is of a step in which proposals learn.",
          .charts = {},
          .tables = {table},
          .pictures = {}};
}

BenchSection MachineSection(const KernelBenchResult& r) {
  const KernelBenchOptions& o = r.options;
  BenchTable table{
      .name = "machine",
      .title = "",
      .note = fmt::format(
          "Networks: {} kFLOP per training sample at {} per thread. Reads and additions: 8 corners with {} features at each of {} levels, at random "
          "positions in tables of up to 2^{} entries. Every row is a median, so parts and sums may differ a little.",
          page::FormatFixed(1e-3 * r.train_flops, 1), page::FormatFixed(r.all.gflops_per_thread, 0, "GFLOP/s"), o.features, o.levels,
          o.log2_table_size),
      .columns = {"limit per sample"},
      .rows = {}};
  for (const char* name : {"networks, training", "random reads", "random additions", "training, all three", "inference, without additions"}) {
    table.rows.push_back({BenchCell::Text(name)});
  }
  for (const KernelSpeed& s : SpeedsOf(r)) {
    table.columns.push_back("ns per thread, " + ThreadsText(s.threads));
    const std::vector<BenchCell> cells = {NsCell(s.network_limit_s), NsCell(s.gather_limit_s), NsCell(s.scatter_limit_s),
                                          NsCell(s.threads / s.roofline_train_samples_per_second),
                                          NsCell(s.threads / s.roofline_infer_samples_per_second)};
    for (size_t i = 0; i < cells.size(); ++i) table.rows[i].push_back(cells[i]);
  }
  return {.id = "machine",
          .title = "The machine's limit",
          .lead = "Measured in the same rounds, on the same number of threads at once.",
          .charts = {},
          .tables = {table},
          .pictures = {}};
}

}  // namespace

std::string KernelBenchJson(const KernelBenchResult& r) {
  const KernelBenchOptions& o = r.options;
  Json json = {{"bench", "kernel"}, {"isa", r.isa}};
  json.update(SpeedJson(r.all));
  if (!r.one_thread.empty()) {
    json["one_thread"] = SpeedJson(r.one_thread.front());
    json["scaling_fraction"] = r.ScalingFraction();
  }
  for (const SamplerSpeed& sampler : r.samplers) {
    json["samplers"][sampler.sampler] = {{"samples", sampler.samples}, {"place_rays_per_second", sampler.place_rays_per_second}};
    if (sampler.learn_rays_per_second > 0.0) json["samplers"][sampler.sampler]["learn_rays_per_second"] = sampler.learn_rays_per_second;
  }
  json["config"] = {{"levels", o.levels},
                    {"features", o.features},
                    {"log2_table_size", o.log2_table_size},
                    {"hidden", o.hidden},
                    {"color_hidden_layers", o.color_hidden_layers},
                    {"sh_degree", o.sh_degree},
                    {"batch_samples", o.batch_samples},
                    {"samples_per_ray", o.samples_per_ray},
                    {"train_flops_per_sample", r.train_flops},
                    {"seconds", o.seconds},
                    {"rounds", o.rounds}};
  json["machine"] = base::MachineDescription();
  json["date"] = base::UtcTimestamp();
  return base::JsonText(json, 2) + "\n";
}

std::string KernelBenchTable(const KernelBenchResult& r) {
  const KernelSpeed& s = r.all;
  const KernelBenchOptions& o = r.options;
  std::string text = fmt::format("{} levels x {} features, 2^{} entries, networks of width {}, {} samples per batch, {}, {} thread{}\n", o.levels,
                                 o.features, o.log2_table_size, o.hidden, o.batch_samples, r.isa, s.threads, s.threads == 1 ? "" : "s");
  const auto row = [&](const std::string& what, const std::string& value, const std::string& note = "") {
    text += fmt::format("  {:<22}{:>12}  {}\n", what, value, note);
  };
  row("training", Million(s.train_samples_per_second),
      fmt::format("{:.0f} % of this machine's limit of {}", 100.0 * s.RooflineFraction(), Million(s.roofline_train_samples_per_second)));
  row("inference", Million(s.infer_samples_per_second),
      fmt::format("{:.1f} times training; limit {}", s.infer_samples_per_second / s.train_samples_per_second,
                  Million(s.roofline_infer_samples_per_second)));
  if (!r.one_thread.empty()) {
    const KernelSpeed& one = r.one_thread.front();
    row("one thread trains", Million(one.train_samples_per_second),
        fmt::format("{:.0f} % of its limit; threads scale to {:.0f} % of the limit's scaling", 100.0 * one.RooflineFraction(),
                    100.0 * r.ScalingFraction()));
  }
  text += fmt::format(
      "Limit per sample and thread: {:.0f} ns networks ({:.1f} kFLOP at {:.0f} GFLOP/s) + {:.0f} ns random reads + {:.0f} ns random additions\n",
      1e9 * s.network_limit_s, 1e-3 * r.train_flops, s.gflops_per_thread, 1e9 * s.gather_limit_s, 1e9 * s.scatter_limit_s);
  text += "Training time by phase:\n";
  const double thread_s = s.threads / s.train_samples_per_second;
  for (size_t i = 0; i < worker::kPhases; ++i) {
    if (s.train_share[i] > 0.0005) {
      row(worker::kPhaseNames[i], fmt::format("{:.1f} %", 100.0 * s.train_share[i]),
          fmt::format("{:.0f} ns per sample", 1e9 * thread_s * s.train_share[i]));
    }
  }
  row("waiting, bookkeeping", fmt::format("{:.1f} %", 100.0 * s.waiting_share),
      fmt::format("{:.0f} ns per sample", 1e9 * thread_s * s.waiting_share));
  if (!r.samplers.empty()) text += "Samplers beside the occupancy grid:\n";
  for (const SamplerSpeed& sampler : r.samplers) {
    const std::string learned = sampler.learn_rays_per_second > 0.0 ? fmt::format(", {:.0f} k/s learned", 1e-3 * sampler.learn_rays_per_second) : "";
    row(sampler.sampler, fmt::format("{:.0f} k rays/s", 1e-3 * sampler.place_rays_per_second),
        "placed in passes of " + PassesText(sampler) + learned);
  }
  return text;
}

BenchPage KernelBenchPage(const KernelBenchResult& r, const std::string& command) {
  const KernelBenchOptions& o = r.options;
  BenchPage page{.name = "kernel",
                 .title = "A field's speed against the machine's limit",
                 .lead = fmt::format(
                     "{} levels of {} features, tables of up to 2^{} entries, networks of width {} with {} hidden layer{} for colour, batches of "
                     "{} samples at random positions. Medians of {} round{} with {:g} s per measurement; the limit is measured in the same "
                     "rounds.",
                     o.levels, o.features, o.log2_table_size, o.hidden, o.color_hidden_layers, o.color_hidden_layers == 1 ? "" : "s",
                     page::FormatInteger(o.batch_samples), o.rounds, o.rounds == 1 ? "" : "s", o.seconds),
                 .figures = KernelFigures(r),
                 .verdicts = KernelVerdicts(r),
                 .sections = {LimitSection(r), PhaseSection(r), SamplerSection(r), MachineSection(r)},
                 .command = command,
                 .machine = base::MachineDescription(),
                 .date = base::UtcTimestamp()};
  return page;
}

}  // namespace skyquilt::bench
