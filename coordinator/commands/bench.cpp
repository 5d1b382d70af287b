#include <CLI/CLI.hpp>
#include <charconv>
#include <iostream>

#include "coordinator/bench/kernel_bench.h"
#include "coordinator/commands/command.h"
#include "core/base/errors.h"
#include "core/base/file.h"
#include "core/base/system.h"

namespace skyquilt::coordinator {
namespace {

int ThreadsFrom(const std::string& text) {
  if (text.empty()) return 0;
  int threads = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), threads);
  if (error != std::errc() || end != text.data() + text.size()) throw base::UsageError("--threads must be a whole number, got '" + text + "'");
  return threads;
}

void AddKernelBench(CLI::App& bench, CommandState& state) {
  struct Flags {
    KernelBenchOptions options;
    std::string out;
    bool quick = false;
    bool json = false;
  };
  const auto flags = std::make_shared<Flags>();
  KernelBenchOptions& o = flags->options;
  CLI::App* command = bench.add_subcommand("kernel", "samples per second of training and rendering a field, against this machine's own limit");
  command->add_option("-o,--output", flags->out, "folder for kernel.json")->type_name("DIR");
  command->add_option("--isa", o.isa, "force an instruction set: avx512, avx2, portable or one by name")->type_name("NAME");
  command->add_option("--levels", o.levels, "resolutions of the hash grid")->type_name("N")->capture_default_str();
  command->add_option("--features", o.features, "numbers per grid entry, 2 or 4")->type_name("N")->capture_default_str();
  command->add_option("--log2-table-size", o.log2_table_size, "entries per level, log2")->type_name("N")->capture_default_str();
  command->add_option("--hidden", o.hidden, "width of the hidden layers")->type_name("N")->capture_default_str();
  command->add_option("--color-hidden-layers", o.color_hidden_layers, "hidden layers of the colour network")->type_name("N")->capture_default_str();
  command->add_option("--sh-degree", o.sh_degree, "spherical harmonics of the direction")->type_name("N")->capture_default_str();
  command->add_option("--batch", o.batch_samples, "samples per step")->type_name("N")->capture_default_str();
  command->add_option("--samples-per-ray", o.samples_per_ray, "of every ray")->type_name("N")->capture_default_str();
  command->add_option("--seconds", o.seconds, "per figure and round")->type_name("S")->capture_default_str();
  command->add_option("--rounds", o.rounds, "medians of so many")->type_name("N")->capture_default_str();
  command->add_flag("--quick", flags->quick, "one short round");
  command->add_flag("--json", flags->json, "print JSON instead of the table");
  command->footer(
      "Examples:\n"
      "  skyquilt bench kernel\n"
      "  skyquilt bench kernel --isa avx2 --json\n"
      "  skyquilt bench kernel --log2-table-size 22 -o out/bench\n"
      "Rates are medians over rounds; the limit is measured in the same rounds. Leave the machine alone meanwhile.");
  command->callback([&state, flags] {
    state.chosen = [&state, flags] {
      if (state.comm != nullptr && state.comm->rank() != 0) return;  // one process measures; others would disturb it
      flags->options.threads = ThreadsFrom(state.threads);
      if (flags->quick) {
        flags->options.rounds = 1;
        flags->options.seconds = std::min(flags->options.seconds, 0.5);
      }
      if (!flags->out.empty()) base::RequireWritableFolder(flags->out);
      const KernelBenchResult result = RunKernelBench(flags->options);
      const std::string json = KernelBenchJson(result);
      std::cout << (flags->json ? json : KernelBenchTable(result));
      if (!flags->out.empty()) base::WriteFileAtomically(std::filesystem::path(flags->out) / "kernel.json", json);
    };
  });
}

}  // namespace

void AddBench(CLI::App& app, CommandState& state) {
  CLI::App* bench = app.add_subcommand("bench", "measure speed on this machine");
  bench->require_subcommand(1);
  AddKernelBench(*bench, state);
}

}  // namespace skyquilt::coordinator
