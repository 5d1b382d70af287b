#include <CLI/CLI.hpp>

#include "app/bench/bench_commands.h"
#include "app/bench/study_command.h"
#include "core/base/errors.h"

namespace skyquilt::app {
namespace {

void CheckLight(const StudyFlags& flags) {
  if (!flags.survey.empty())
    throw base::UsageError("bench light needs the same photos under many lights, so it takes --place NAME instead of --survey");
  if (!flags.seeds.empty()) throw base::UsageError("bench light takes no --seeds: give another seed with --set run.seed=N and another folder");
  if (flags.steps > 0 && !flags.budget.empty()) throw base::UsageError("--steps and --time-budget exclude each other");
}

std::vector<config::Override> LightOverrides(const StudyFlags& flags) {
  std::vector<config::Override> overrides = bench::SunLights();
  if (flags.steps > 0) overrides.push_back({"train.steps", std::to_string(flags.steps)});
  if (flags.quick) overrides.push_back({"simulate.lights_every", "4"});
  return overrides;
}

bench::StudyBench RunLight(bench::Study& study, const StudyFlags& flags) {
  bench::LightBenchOptions options;
  options.budget_s = flags.steps > 0 ? 0.0 : BudgetOf(flags, options.budget_s, 3.0);
  return bench::LightBench(study, options);
}

}  // namespace

void AddLightBench(CLI::App& bench, CommandState& state) {
  AddStudyCommand(
      bench, state,
      {.name = "light",
       .help = "mix the codes of lights, and compare with photos of the light between",
       .place = "hamlet",
       .budget = "1min",
       .footer = "Examples:\n"
                 "  skyquilt bench light -o out/light\n"
                 "  skyquilt bench light --place town --steps 3000 -o out/light\n"
                 "Seven trainings. Also writes light.png with photos and renderings side by side. After an interruption, the same command\n"
                 "continues.",
       .defaults = {{"simulate.image_width", "240"},
                    {"run.image_width", "240"},
                    {"simulate.oblique", "false"},
                    {"simulate.moving_cars", "0"},
                    {"simulate.exposure_drift_stops", "0"},
                    {"simulate.exposure_jumps_stops", "0"},
                    {"simulate.exposure_offset_stops", "-0.7"},
                    {"partition.blocks", "1x1"},
                    {"train.appearance_codes", "8"},
                    {"train.appearance_of", "folder"},
                    {"evaluate.max_photos", "6"}},
       .options =
           [](CLI::App* command, StudyFlags* flags) {
             command->add_option("--steps", flags->steps, "train every variant for this many steps instead of a time")
                 ->check(CLI::Range(1, 10000000))
                 ->type_name("N");
           },
       .overrides = LightOverrides,
       .check = CheckLight,
       .run = RunLight});
}

}  // namespace skyquilt::app
