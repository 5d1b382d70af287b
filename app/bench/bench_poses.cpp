#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "app/bench/bench_commands.h"
#include "bench/poses/poses_bench.h"
#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::app {
namespace {

void CheckSizes(const std::vector<int>& photos) {
  std::vector<int> sizes = photos;
  std::sort(sizes.begin(), sizes.end());
  if (std::adjacent_find(sizes.begin(), sizes.end()) != sizes.end()) throw base::UsageError("--photos names a number twice");
}

}  // namespace

void AddPosesBench(CLI::App& bench, CommandState& state) {
  struct Flags {
    std::string out, place;
    std::vector<std::string> sets, ways;
    std::vector<int> photos;
    bool keep = false, json = false;
  };
  const auto flags = std::make_shared<Flags>();
  CLI::App* command = bench.add_subcommand("poses", "poses of simulated photos that are hard to place, in both ways, against the truth");
  command->add_option("-o,--out,--output", flags->out, "folder for poses.json, poses.html and tables as CSV")->required()->type_name("DIR");
  command->add_option("--sets", flags->sets, "photo sets: plain, two_cameras, turned, blurred, other_place, no_tags, solar_farm; default: all")
      ->delimiter(',')
      ->check(CLI::IsMember(bench::PhotoSetNames()))
      ->type_name("SET,...");
  command->add_option("--photos", flags->photos, "photos per set, of the middle of the flight; several: how the time per photo grows; default: all")
      ->delimiter(',')
      ->check(CLI::Range(bench::kIntruders, 100000))
      ->type_name("N,...");
  command->add_option("--ways", flags->ways, "values of prepare.poses: fast, colmap; default: both")
      ->delimiter(',')
      ->check(CLI::IsMember({bench::kFastWay, bench::kColmapWay}))
      ->type_name("WAY,...");
  AddPlaceFlag(
      *command, "--place", [flags](const std::string& place) { flags->place = place; },
      "simulated place; default: that of the settings, town, and smallcity flown at 100 m when --photos asks for more than 100");
  command->add_flag("--keep", flags->keep, "keep photos, databases and models in DIR/poses_work");
  command->add_flag("--json", flags->json, "print JSON instead of the tables");
  command->footer(
      "Examples:\n"
      "  skyquilt bench poses -o out/bench\n"
      "  skyquilt bench poses -o out/bench --sets turned,no_tags --photos 60\n"
      "  skyquilt bench poses -o out/bench --sets plain --photos 100,500 --ways fast\n"
      "Needs COLMAP. Run nothing else on the machine meanwhile.");
  command->callback([&state, flags] {
    state.run_command = [&state, flags] {
      if (state.comm != nullptr && state.comm->rank() != 0) return;
      CheckSizes(flags->photos);
      const coordinator::Settings settings = state.LoadOver({});
      bench::PosesBenchOptions options;
      options.folder = std::filesystem::absolute(flags->out);
      for (const std::string& name : flags->sets) options.sets.push_back(bench::PhotoSetOf(name));
      options.photos = flags->photos;
      options.ways = flags->ways;
      options.simulate = settings.simulate;
      if (!flags->place.empty()) options.place = flags->place;
      options.poses = prepare::PoseOptionsOf(settings.prepare);
      options.threads = BenchThreads(state);
      options.keep = flags->keep;
      base::RequireWritableFolder(flags->out);
      size_t n_rows = 0;
      // After each row: a single one may take COLMAP half an hour.
      options.on_row = [&](const bench::PosesResult& result) {
        n_rows = result.rows.size();
        bench::WriteBench(flags->out, bench::PosesPage(result, state.command_line), bench::PosesJson(result, state.command_line));
      };
      try {
        const bench::PosesResult result = bench::RunPosesBench(options);
        std::cout << (flags->json ? bench::PosesJson(result, state.command_line) : bench::BenchText(bench::PosesPage(result, state.command_line)));
      } catch (const base::Interrupted&) {
        throw base::Interrupted(
            fmt::format("interrupted; {} finished row{} in {}; the same command begins anew", n_rows, n_rows == 1 ? " is" : "s are", flags->out));
      }
    };
  });
}

}  // namespace skyquilt::app
