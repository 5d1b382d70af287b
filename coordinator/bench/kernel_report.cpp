#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "coordinator/bench/kernel_bench.h"
#include "core/base/system.h"

namespace skyquilt::coordinator {
namespace {

using Json = nlohmann::ordered_json;

Json SpeedJson(const KernelSpeed& s) {
  Json share;
  for (size_t i = 0; i < worker::kStages; ++i) {
    if (s.train_share[i] > 0.0) share[worker::kStageNames[i]] = s.train_share[i];
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

}  // namespace

std::string KernelBenchJson(const KernelBenchResult& r) {
  const KernelBenchOptions& o = r.options;
  Json json = {{"bench", "kernel"}, {"isa", r.isa}};
  json.update(SpeedJson(r.all));
  if (!r.one_thread.empty()) {
    json["one_thread"] = SpeedJson(r.one_thread.front());
    json["scaling_fraction"] = r.ScalingFraction();
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
  return json.dump(2) + "\n";
}

std::string KernelBenchTable(const KernelBenchResult& r) {
  const KernelSpeed& s = r.all;
  const KernelBenchOptions& o = r.options;
  std::string text = fmt::format("{} levels x {} features, 2^{} entries, {}-wide networks, {} samples a batch, {}, {} thread{}\n", o.levels,
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
  text += "Where training time goes:\n";
  const double thread_s = s.threads / s.train_samples_per_second;
  for (size_t i = 0; i < worker::kStages; ++i) {
    if (s.train_share[i] > 0.0005) {
      row(worker::kStageNames[i], fmt::format("{:.1f} %", 100.0 * s.train_share[i]),
          fmt::format("{:.0f} ns a sample", 1e9 * thread_s * s.train_share[i]));
    }
  }
  row("waiting, bookkeeping", fmt::format("{:.1f} %", 100.0 * s.waiting_share), fmt::format("{:.0f} ns a sample", 1e9 * thread_s * s.waiting_share));
  return text;
}

}  // namespace skyquilt::coordinator
