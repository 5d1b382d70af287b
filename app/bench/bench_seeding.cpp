#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "app/bench/bench_commands.h"
#include "bench/study/seeding_bench.h"
#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::app {
namespace {

// 5,544 photos with the usual overlap, by a usual drone: gimbal angles are off by a degree, positions by a metre and a half.
const std::vector<config::Override> kWideFlight = {
    {"simulate.place", "smallcity"},  {"simulate.altitudes", "50"},    {"simulate.forward_overlap", "0.8"},      {"simulate.side_overlap", "0.7"},
    {"simulate.image_width", "1600"}, {"simulate.gps_noise_m", "1.5"}, {"simulate.gimbal_random_error_deg", "1"}};
// --quick
const std::vector<config::Override> kShortFlight = {
    {"simulate.place", "hamlet"}, {"simulate.altitudes", "45"}, {"simulate.forward_overlap", "0.85"}, {"simulate.side_overlap", "0.8"}};

}  // namespace

void AddSeedingBench(CLI::App& bench, CommandState& state) {
  struct Flags {
    bench::SeedingOptions options;
    std::string out;
    bool quick = false, json = false;
  };
  const auto flags = std::make_shared<Flags>();
  bench::SeedingOptions& o = flags->options;
  CLI::App* command = bench.add_subcommand("seeding", "time, memory and errors of poses by tags and matches, by number of photos");
  command->add_option("-o,--out,--output", flags->out, "folder for seeding.json, seeding.html and tables as CSV")->required()->type_name("DIR");
  const CLI::Option* photos = command->add_option("--photos", o.photos, "numbers of photos, of the middle of the flight; default: 500,1000,2000,5000")
                                  ->delimiter(',')
                                  ->check(CLI::Range(8, 1'000'000))
                                  ->type_name("N,...");
  command->add_option("--thread-counts", o.threads, "numbers of threads, one after the other; default: 1,2")
      ->delimiter(',')
      ->check(CLI::Range(1, 1024))
      ->type_name("N,...");
  command->add_option("--features", o.features_per_photo, "features per photo, about")->check(CLI::Range(100.0, 20000.0))->capture_default_str();
  command->add_option("--noise", o.errors.noise_px, "noise of features, pixels, one standard deviation per axis")
      ->check(CLI::Range(0.0, 10.0))
      ->type_name("PX")
      ->capture_default_str();
  command->add_option("--seen", o.errors.seen_share, "of the photos that show a point, the share that has a feature there")
      ->check(CLI::Range(0.01, 1.0))
      ->type_name("SHARE")
      ->capture_default_str();
  command->add_option("--wrong", o.errors.wrong_share, "share of the matches that are wrong")
      ->check(CLI::Range(0.0, 0.5))
      ->type_name("SHARE")
      ->capture_default_str();
  command->add_flag("--quick", flags->quick, "test with 12 and 24 photos of a hamlet");
  command->add_flag("--json", flags->json, "print JSON instead of the tables");
  command->footer(
      "Examples:\n"
      "  skyquilt bench seeding -o out/bench\n"
      "  skyquilt bench seeding -o out/bench --photos 500,1000 --wrong 0.1\n"
      "No picture is rendered and no feature is sought. Run nothing else on the machine meanwhile.");
  command->callback([&state, flags, photos] {
    state.run_command = [&state, flags, photos] {
      if (state.comm != nullptr && state.comm->rank() != 0) return;
      coordinator::Settings own;
      for (const config::Override& entry : kWideFlight) own.Set(entry);
      if (flags->quick) {
        for (const config::Override& entry : kShortFlight) own.Set(entry);
      }
      bench::SeedingOptions options = flags->options;
      options.simulate = state.LoadOver(own).simulate;
      if (flags->quick && photos->empty()) options.photos = {12, 24};
      base::RequireWritableFolder(flags->out);
      options.on_row = [&](const bench::SeedingResult& result) {
        bench::WriteBench(flags->out, bench::SeedingPage(result, state.command_line), bench::SeedingJson(result, state.command_line));
      };
      const bench::SeedingResult result = bench::RunSeedingBench(options);
      std::cout << (flags->json ? bench::SeedingJson(result, state.command_line) : bench::BenchText(bench::SeedingPage(result, state.command_line)));
      if (!flags->json) std::cout << "\n" << (std::filesystem::absolute(flags->out) / "seeding.html").string() << "\n";
    };
  });
}

}  // namespace skyquilt::app
