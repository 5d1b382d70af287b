#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "app/bench/bench_commands.h"
#include "app/settings/duration.h"
#include "bench/study/growth_bench.h"
#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::app {
namespace {

// A city flown so densely that it has 5,236 photos, traced cheaply in small pictures, and small tables: the time of stages that grow with photos
// counts, not that of pixels.
const std::vector<config::Override> kDenseCity = {
    {"simulate.place", "smallcity"}, {"simulate.altitudes", "100"},           {"simulate.forward_overlap", "0.9"}, {"simulate.side_overlap", "0.84"},
    {"simulate.image_width", "96"},  {"simulate.samples_per_pixel", "1"},     {"simulate.soft_shadows", "false"},  {"run.memory_gb", "4"},
    {"run.time_budget_s", "120"},    {"partition.max_log2_table_size", "15"}, {"products.video_seconds", "0"},     {"evaluate.report_photos", "2"}};
// --quick
const std::vector<config::Override> kSmallPlace = {
    {"simulate.place", "hamlet"},           {"simulate.altitudes", "45"}, {"simulate.forward_overlap", "0.85"},
    {"simulate.side_overlap", "0.8"},       {"run.time_budget_s", "4"},   {"partition.max_log2_table_size", "12"},
    {"partition.min_log2_table_size", "8"},
};

}  // namespace

void AddScaleBench(CLI::App& bench, CommandState& state) {
  struct Flags {
    std::string out, budget;
    std::vector<int> photos;
    bool quick = false, keep = false, json = false;
  };
  const auto flags = std::make_shared<Flags>();
  CLI::App* command = bench.add_subcommand("scale", "time and memory of every stage by number of photos");
  command->add_option("-o,--out,--output", flags->out, "folder for scale.json, scale.html and tables as CSV")->required()->type_name("DIR");
  command->add_option("--photos", flags->photos, "numbers of photos, of the middle of the flight; default: 500,1000,2000,5000")
      ->delimiter(',')
      ->check(CLI::Range(8, 1'000'000))
      ->type_name("N,...");
  command->add_option("--time-budget", flags->budget, "training time of every survey; default: 2min")->type_name("TIME");
  command->add_flag("--quick", flags->quick, "test with 12 and 24 photos of a hamlet: figures without meaning");
  command->add_flag("--keep", flags->keep, "keep surveys and projects in DIR/scale_work");
  command->add_flag("--json", flags->json, "print JSON instead of the tables");
  command->footer(
      "Examples:\n"
      "  skyquilt bench scale -o out/bench\n"
      "  skyquilt bench scale -o out/bench --photos 500,1000,2000\n"
      "After an interruption, the same command continues with the unfinished survey. Run nothing else on the machine meanwhile.");
  command->callback([&state, flags] {
    state.run_command = [&state, flags] {
      coordinator::Settings own;
      for (const config::Override& entry : kDenseCity) own.Set(entry);
      if (flags->quick) {
        for (const config::Override& entry : kSmallPlace) own.Set(entry);
      }
      bench::GrowthOptions options;
      options.settings = state.LoadOver(own);
      if (!flags->budget.empty()) options.settings.run.time_budget_s = ParseDurationSeconds(flags->budget);
      options.folder = std::filesystem::absolute(flags->out);
      if (flags->quick) options.photos = {12, 24};
      if (!flags->photos.empty()) options.photos = flags->photos;
      options.keep = flags->keep;
      options.quiet = state.quiet;
      options.verbose = state.verbose;
      base::RequireWritableFolder(options.folder);
      options.on_row = [&](const bench::GrowthResult& result) {
        bench::WriteBench(options.folder, bench::GrowthPage(result, state.command_line), bench::GrowthJson(result, state.command_line));
      };
      const bench::GrowthResult result = bench::RunGrowthBench(*state.comm, options);
      std::cout << (flags->json ? bench::GrowthJson(result, state.command_line) : bench::BenchText(bench::GrowthPage(result, state.command_line)));
      if (!flags->json) std::cout << "\n" << (options.folder / "scale.html").string() << "\n";
    };
  });
}

}  // namespace skyquilt::app
