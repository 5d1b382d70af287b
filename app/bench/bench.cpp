#include <CLI/CLI.hpp>
#include <charconv>
#include <filesystem>
#include <iostream>
#include <string>

#include "app/bench/bench_commands.h"
#include "app/commands/command.h"
#include "bench/bench_page.h"
#include "bench/kernel_bench.h"
#include "bench/rank_shares.h"
#include "bench/schedule_bench.h"
#include "core/base/errors.h"
#include "core/base/file.h"

namespace skyquilt::app {
namespace {

constexpr int kQuickBlocks = 1000, kQuickRanks = 100;

void AddKernelBench(CLI::App& bench, CommandState& state) {
  struct Flags {
    bench::KernelBenchOptions options;
    std::string out;
    bool quick = false;
    bool json = false;
  };
  const auto flags = std::make_shared<Flags>();
  bench::KernelBenchOptions& o = flags->options;
  CLI::App* command = bench.add_subcommand("kernel", "samples per second in training and rendering, compared with the limit of this machine");
  command->add_option("-o,--out,--output", flags->out, "folder for kernel.json, kernel.html and tables as CSV")->type_name("DIR");
  command->add_option("--isa", o.isa, "force an instruction set: avx512, avx2, portable or one by name")->type_name("NAME");
  command->add_option("--levels", o.levels, "resolutions of the hash grid")->type_name("N")->capture_default_str();
  command->add_option("--features", o.features, "features per grid entry, 2 or 4")->type_name("N")->capture_default_str();
  command->add_option("--log2-table-size", o.log2_table_size, "log2 of the entries per level")->type_name("N")->capture_default_str();
  command->add_option("--hidden", o.hidden, "width of the hidden layers")->type_name("N")->capture_default_str();
  command->add_option("--color-hidden-layers", o.color_hidden_layers, "hidden layers of the colour network")->type_name("N")->capture_default_str();
  command->add_option("--sh-degree", o.sh_degree, "degree of the spherical harmonics of the viewing direction")
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--batch", o.batch_samples, "samples per step")->type_name("N")->capture_default_str();
  command->add_option("--samples-per-ray", o.samples_per_ray, "samples on every ray")->type_name("N")->capture_default_str();
  command->add_option("--seconds", o.seconds, "duration of one measurement")->type_name("S")->capture_default_str();
  command->add_option("--rounds", o.rounds, "rounds of measurements; medians are reported")->type_name("N")->capture_default_str();
  command->add_flag("--quick", flags->quick, "one short round");
  command->add_flag("--json", flags->json, "print JSON instead of the table");
  command->footer(
      "Examples:\n"
      "  skyquilt bench kernel\n"
      "  skyquilt bench kernel --isa avx2 --json\n"
      "  skyquilt bench kernel --log2-table-size 22 -o out/bench\n"
      "Rates are medians over rounds; the limit is measured in the same rounds. Run nothing else on the machine meanwhile.");
  command->callback([&state, flags] {
    state.run_command = [&state, flags] {
      if (state.comm != nullptr && state.comm->rank() != 0) return;  // only one process measures; others would slow it down
      flags->options.threads = BenchThreads(state);
      if (flags->quick) {
        flags->options.rounds = 1;
        flags->options.seconds = std::min(flags->options.seconds, 0.5);
      }
      if (!flags->out.empty()) base::RequireWritableFolder(flags->out);
      const bench::KernelBenchResult result = bench::RunKernelBench(flags->options);
      const std::string json = bench::KernelBenchJson(result);
      std::cout << (flags->json ? json : bench::KernelBenchTable(result));
      if (!flags->out.empty()) bench::WriteBench(flags->out, bench::KernelBenchPage(result, state.command_line), json);
    };
  });
}

// `bench schedule --stages`
void ShowRankShares(const std::string& project, const bench::RankShareOptions& options, const std::string& out, bool as_json,
                    const CommandState& state) {
  const bench::RankShares shares = bench::ShareAmongRanks(bench::ReadMeasuredRun(std::filesystem::absolute(project)), options);
  const bench::BenchPage page = bench::RankSharesPage(shares, state.command_line);
  const std::string json = bench::RankSharesJson(shares, state.command_line);
  std::cout << (as_json ? json : bench::BenchText(page));
  if (!out.empty()) bench::WriteBench(out, page, json);
}

void AddScheduleBench(CLI::App& bench, CommandState& state) {
  struct Flags {
    bench::ScheduleBenchOptions options;
    bench::RankShareOptions shares;
    std::string out, measured, stages;
    bool quick = false;
    bool json = false;
  };
  const auto flags = std::make_shared<Flags>();
  bench::ScheduleBenchOptions& o = flags->options;
  CLI::App* command = bench.add_subcommand("schedule", "predict how well a cluster would be used: the scheduler with simulated ranks");
  command->add_option("-o,--out,--output", flags->out, "folder for schedule.json, schedule.html and tables as CSV")->type_name("DIR");
  const CLI::Option* blocks = command->add_option("--blocks", o.blocks, "blocks to train")->type_name("N")->capture_default_str();
  const CLI::Option* ranks =
      command->add_option("--ranks", o.ranks, "ranks, including rank 0, which only hands out blocks")->type_name("N")->capture_default_str();
  command->add_option("--block-seconds", o.block_seconds, "mean training time of a block on one rank")->type_name("S")->capture_default_str();
  command->add_option("--measured", flags->measured, "train.json of a project, whose block times are used")->type_name("FILE");
  command->add_option("--stages", flags->stages, "a finished project: instead, how much of the time rank 0 would work alone with several ranks")
      ->type_name("DIR");
  command->add_option("--rank-counts", flags->shares.ranks, "with --stages: numbers of ranks; default: 1,2,4,16,64")
      ->delimiter(',')
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N,...");
  command->add_option("--cost-spread", o.cost_spread, "standard deviation of log(block time), without --measured")
      ->type_name("X")
      ->capture_default_str();
  command->add_option("--cost-error", o.cost_error, "standard deviation of log(estimated cost / true cost)")->type_name("X")->capture_default_str();
  command->add_option("--speed-spread", o.speed_spread, "standard deviation of log(rank speed)")->type_name("X")->capture_default_str();
  command->add_option("--stragglers", o.stragglers, "fraction of ranks at half speed")->type_name("SHARE")->capture_default_str();
  command->add_option("--failing", o.failing, "fraction of ranks lost during the job")->type_name("SHARE")->capture_default_str();
  command->add_option("--checkpoint-every", o.checkpoint_every_s, "seconds between checkpoints")->type_name("S")->capture_default_str();
  command->add_option("--restart-seconds", o.restart_s, "time from the loss of a rank until all ranks train again")
      ->type_name("S")
      ->capture_default_str();
  command->add_option("--skip-seconds", o.skip_s, "time to skip a finished block after a restart")->type_name("S")->capture_default_str();
  command->add_option("--move-seconds", o.move_s, "time to save a slow rank's block, and again to load it on another rank")
      ->type_name("S")
      ->capture_default_str();
  command->add_option("--status-every", o.status_every_s, "time between two progress reports of a rank")->type_name("S")->capture_default_str();
  command->add_option("--seed", o.seed, "seed of the random numbers")->type_name("N")->capture_default_str();
  command->add_flag("--quick", flags->quick,
                    "a small cluster: " + std::to_string(kQuickBlocks) + " blocks on " + std::to_string(kQuickRanks) +
                        " ranks, unless --blocks or --ranks is given");
  command->add_flag("--json", flags->json, "print JSON instead of the table");
  command->footer(
      "Examples:\n"
      "  skyquilt bench schedule\n"
      "  skyquilt bench schedule --quick -o out/bench\n"
      "  skyquilt bench schedule --blocks 400 --ranks 64 --block-seconds 1800 --measured out/train.json\n"
      "  skyquilt bench schedule --stages out --blocks 400\n"
      "Simulates the job twice: undisturbed, and with lost ranks, after which the job starts again from its checkpoints. With --stages, --blocks is\n"
      "that of a larger survey of the same kind; default: the project's own.");
  command->callback([&state, flags, blocks, ranks] {
    state.run_command = [&state, flags, blocks, ranks] {
      if (state.comm != nullptr && state.comm->rank() != 0) return;
      if (flags->quick && blocks->empty()) flags->options.blocks = kQuickBlocks;
      if (flags->quick && ranks->empty()) flags->options.ranks = kQuickRanks;
      if (!flags->measured.empty()) flags->options.measured_seconds = bench::MeasuredBlockSeconds(flags->measured);
      if (!flags->out.empty()) base::RequireWritableFolder(flags->out);
      if (!flags->stages.empty()) {
        if (!blocks->empty()) flags->shares.blocks = flags->options.blocks;
        flags->shares.cost_error = flags->options.cost_error;
        flags->shares.speed_spread = flags->options.speed_spread;
        flags->shares.seed = flags->options.seed;
        ShowRankShares(flags->stages, flags->shares, flags->out, flags->json, state);
        return;
      }
      const bench::ScheduleBenchResult result = bench::RunScheduleBench(flags->options);
      const std::string json = bench::ScheduleBenchJson(result);
      std::cout << (flags->json ? json : bench::ScheduleBenchTable(result));
      if (!flags->out.empty()) bench::WriteBench(flags->out, bench::ScheduleBenchPage(result, state.command_line), json);
    };
  });
}

}  // namespace

int BenchThreads(const CommandState& state) {
  const std::string& text = state.threads;
  if (text.empty()) return 0;
  int threads = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), threads);
  if (error != std::errc() || end != text.data() + text.size()) throw base::UsageError("--threads must be a whole number, got '" + text + "'");
  return threads;
}

void AddBench(CLI::App& app, CommandState& state) {
  CLI::App* bench = app.add_subcommand("bench", "measure speed and accuracy");
  bench->require_subcommand(1);
  AddKernelBench(*bench, state);
  AddScheduleBench(*bench, state);
  AddNumericsBench(*bench, state);
  AddPosesBench(*bench, state);
  AddStudyBenches(*bench, state);
  AddStabilityBench(*bench, state);
  AddScaleBench(*bench, state);
  AddSeedingBench(*bench, state);
}

}  // namespace skyquilt::app
