#include <CLI/CLI.hpp>

#include "app/bench/bench_commands.h"
#include "app/bench/study_command.h"
#include "app/settings/presets.h"
#include "bench/study/data_set.h"
#include "core/base/errors.h"
#include "core/base/text.h"

namespace skyquilt::app {
namespace {

void CheckMethods(const StudyFlags& flags) {
  if (flags.data.empty() && !flags.pictures.empty()) throw base::UsageError("--pictures is for a data set: give its folder with --data");
  if (flags.data.empty() && flags.steps > 0) throw base::UsageError("--steps is for --data; methods are compared at equal time, by --time-budget");
  if (!flags.data.empty()) {
    const bool of_places = !flags.overlaps.empty() || !flags.altitudes.empty() || !flags.place.empty();
    if (of_places || !flags.survey.empty() || !flags.model.empty() || !flags.blocks.empty()) {
      throw base::UsageError(
          "--data has its own pictures, poses and split, and each method is one field: leave out --survey, --model, --place, --blocks, "
          "--overlaps and --altitudes");
    }
    if (flags.steps > 0 && !flags.budget.empty()) throw base::UsageError("--steps and --time-budget exclude each other");
  }
  if (!flags.survey.empty() && !(flags.overlaps.empty() && flags.altitudes.empty())) {
    throw base::UsageError("--overlaps and --altitudes are for a simulated place, so they need --place NAME instead of --survey");
  }
  if (flags.blocks == "1x1") throw base::UsageError("--blocks 1x1 is the one field that blocks are compared with: give more, such as 1x5");
}

std::vector<config::Override> FirstFlight(const StudyFlags& flags) {
  std::vector<config::Override> overrides = bench::FirstSurvey(flags.overlaps, flags.altitudes);
  if (flags.steps > 0) overrides.push_back({"train.steps", std::to_string(flags.steps)});
  return overrides;
}

std::vector<bench::StudiedPreset> Methods(const StudyFlags& flags) {
  std::vector<bench::StudiedPreset> methods;
  for (const std::string& name : flags.variants.empty() ? MethodNames() : flags.variants) methods.push_back({name, PresetOverrides(name), {}});
  return methods;
}

bench::StudyBench RunMethods(bench::Study& study, const StudyFlags& flags) {
  if (!flags.data.empty()) {
    bench::DataSetOptions options;
    options.methods = Methods(flags);
    options.data_set = bench::FindDataSet(flags.data, flags.pictures).name;
    options.budget_s = flags.steps > 0 ? 0.0 : BudgetOf(flags, options.budget_s, 5.0);
    options.seeds = flags.seeds;
    return bench::DataSetBench(study, options);
  }
  bench::MethodsOptions options;
  options.budget_s = BudgetOf(flags, options.budget_s, 5.0);
  if (flags.quick) options.blocks = "1x2";
  if (!flags.blocks.empty()) options.blocks = flags.blocks;
  options.methods = Methods(flags);
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
  command
      ->add_option("--data", flags->data,
                   "scene of a published data set (Blender, LLFF, Mip-NeRF 360, MatrixCity) with its own split, one field a method")
      ->type_name("FOLDER");
  command->add_option("--pictures", flags->pictures, "with --data: its folder of pictures, such as images_4; default: the set's")->type_name("NAME");
  command->add_option("--steps", flags->steps, "with --data: train for this many steps instead of a time")
      ->check(CLI::Range(1, 10000000))
      ->type_name("N");
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
                             "  skyquilt bench methods --data lego --methods instant-ngp,nerfacto -o out/lego\n"
                             "What each method is: configs/methods and docs/methods.md. Also writes methods.png with crops side by side. After an\n"
                             "interruption, the same command continues; methods may be added.",
                   .defaults = {{"evaluate.max_photos", "8"}},
                   .options = AddMethodsOptions,
                   .overrides = FirstFlight,
                   .check = CheckMethods,
                   .run = RunMethods});
}

}  // namespace skyquilt::app
