#include <CLI/CLI.hpp>

#include "app/bench/bench_commands.h"
#include "app/bench/study_command.h"
#include "app/settings/presets.h"
#include "core/base/errors.h"
#include "core/base/text.h"

namespace skyquilt::app {
namespace {

void CheckMethods(const StudyFlags& flags) {
  if (!flags.survey.empty() && !(flags.overlaps.empty() && flags.altitudes.empty())) {
    throw base::UsageError("--overlaps and --altitudes are for a simulated place, so they need --place NAME instead of --survey");
  }
  if (flags.blocks == "1x1") throw base::UsageError("--blocks 1x1 is the one field that blocks are compared with: give more, such as 1x5");
}

std::vector<config::Override> FirstFlight(const StudyFlags& flags) {
  return bench::FirstSurvey(flags.overlaps, flags.altitudes);
}

bench::StudyBench RunMethods(bench::Study& study, const StudyFlags& flags) {
  bench::MethodsOptions options;
  options.budget_s = BudgetOf(flags, options.budget_s, 5.0);
  if (flags.quick) options.blocks = "1x2";
  if (!flags.blocks.empty()) options.blocks = flags.blocks;
  for (const std::string& name : flags.variants.empty() ? MethodNames() : flags.variants) {
    options.methods.push_back({name, PresetOverrides(name), {}});
  }
  options.seeds = flags.seeds;
  options.overlaps = flags.overlaps;
  options.altitudes_m = flags.altitudes;
  return bench::MethodsBench(study, options);
}

// The options that only `bench methods` has.
void AddMethodsOptions(CLI::App* command, StudyFlags* flags) {
  command->add_option("--methods", flags->variants, "methods to compare: " + base::Join(MethodNames()) + "; default: all")
      ->delimiter(',')
      ->check(CLI::IsMember(MethodNames()))
      ->type_name("NAME,...");
  command->add_option("--blocks", flags->blocks, "rows x columns of the variants with several blocks; default: 1x5, with --quick 1x2")
      ->type_name("RxC");
  command
      ->add_option("--overlaps", flags->overlaps,
                   "simulated places: also fly with these shares of a photo that the next one sees too, along and across the lines, such as 0.6,0.8")
      ->delimiter(',')
      ->check(CLI::Range(0.0, 0.95))
      ->type_name("X,...");
  command->add_option("--altitudes", flags->altitudes, "simulated places: also fly at these heights above ground in metres, such as 80,120")
      ->delimiter(',')
      ->check(CLI::Range(40.0, 2000.0))
      ->type_name("M,...");
}

}  // namespace

void AddMethodsBench(CLI::App& bench, CommandState& state) {
  AddStudyCommand(bench, state,
                  {.name = "methods",
                   .help = "compare published methods, each as one field and as blocks",
                   .place = "smallcity",
                   .budget = "5min",
                   .footer = "Examples:\n"
                             "  skyquilt bench methods -o out/bench\n"
                             "  skyquilt bench methods --methods instant-ngp,tensorf,nerf --blocks 5x1 --seeds 1,2,3 -o out/bench\n"
                             "  skyquilt bench methods --place town --overlaps 0.6,0.8 --altitudes 80,120 -o out/bench\n"
                             "What each method is: configs/methods and docs/methods.md. Also writes methods.png with crops side by side. After an\n"
                             "interruption, the same command continues; methods may be added.",
                   .defaults = {{"evaluate.max_photos", "8"}},
                   .options = AddMethodsOptions,
                   .overrides = FirstFlight,
                   .check = CheckMethods,
                   .run = RunMethods});
}

}  // namespace skyquilt::app
