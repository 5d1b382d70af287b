#include "app/bench/study_command.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>

#include "app/settings/duration.h"
#include "bench/study/data_set.h"
#include "bench/study/study_tables.h"
#include "core/base/errors.h"

namespace skyquilt::app {
namespace {

// Outputs that a comparison does not need are reduced.
const std::vector<config::Override> kLean = {
    {"products.video_seconds", "0"}, {"evaluate.report_photos", "6"}, {"evaluate.report_image_width", "640"}};
// --quick: small photos and small tables.
const std::vector<config::Override> kQuick = {{"run.image_width", "320"}, {"evaluate.report_photos", "2"}, {"partition.max_log2_table_size", "15"}};

bench::Study Begin(const CommandState& state, const StudyFlags& flags, const StudyCommand& command) {
  // Total times are for all outputs.
  std::vector<config::Override> own = flags.within.empty() ? kLean : std::vector<config::Override>();
  if (flags.quick) own.insert(own.end(), kQuick.begin(), kQuick.end());
  own.insert(own.end(), command.defaults.begin(), command.defaults.end());
  if (!flags.data.empty()) {
    const std::vector<config::Override> of_set = bench::FindDataSet(flags.data, flags.pictures).overrides;
    own.insert(own.end(), of_set.begin(), of_set.end());
    // The pictures as they are, and all that the split holds out.
    own.insert(own.end(), {{"run.image_width", "0"}, {"brightness.correction", "none"}, {"evaluate.max_photos", "0"}});
  }
  // --config and --set come last, so that the user's values win.
  coordinator::Settings settings;
  for (const config::Override& entry : own) settings.Set(entry);
  settings = state.LoadOver(settings);
  if (command.overrides) {
    for (const config::Override& entry : command.overrides(flags)) settings.Set(entry);
  }
  // Variants are compared at one width.
  if (settings.run.image_width == coordinator::kAutoWidth && flags.within.empty()) settings.run.image_width = coordinator::kLeastAutoWidth;
  bench::StudySurvey survey{.folder = flags.survey, .place = flags.place, .model = flags.model};
  if (!flags.data.empty()) {
    const bench::DataSet set = bench::FindDataSet(flags.data, flags.pictures);
    survey.folder = set.pictures;
    survey.model = set.model;
  }
  if (survey.folder.empty() && survey.place.empty()) survey.place = flags.quick ? "hamlet" : command.place;
  if (!survey.folder.empty() && !std::filesystem::is_directory(survey.folder)) {
    throw base::InputError(survey.folder, "no such folder", "Give the folder that holds the photos, or a project");
  }
  return bench::Study(*state.comm, {.folder = flags.out,
                                    .survey = survey,
                                    .settings = settings,
                                    .restart = flags.restart,
                                    .keep = flags.keep,
                                    .quiet = state.quiet,
                                    .verbose = state.verbose});
}

void WriteResults(bench::StudyBench bench, const bench::Study& study, const CommandState& state, const StudyFlags& flags) {
  bench::BenchPage& page = bench.page;
  page.SetOrigin(state.command_line);
  const std::string json = bench::StudyJson(page, bench.results, study.settings().Toml());
  bench::WriteBench(flags.out, page, json);
  std::cout << (flags.json ? json : bench::BenchText(page));
  if (!flags.json) std::cout << "\n" << (std::filesystem::path(flags.out) / (page.name + ".html")).string() << "\n";
}

void CheckSeeds(const StudyFlags& flags) {
  std::vector<int> seeds = flags.seeds;
  std::sort(seeds.begin(), seeds.end());
  if (std::adjacent_find(seeds.begin(), seeds.end()) != seeds.end()) throw base::UsageError("--seeds names a seed twice");
}

}  // namespace

double BudgetOf(const StudyFlags& flags, double otherwise_s, double quick_s) {
  if (!flags.budget.empty()) return ParseDurationSeconds(flags.budget);
  return flags.quick ? quick_s : otherwise_s;
}

void AddStudyCommand(CLI::App& bench, CommandState& state, const StudyCommand& study_command) {
  const auto flags = std::make_shared<StudyFlags>();
  const std::string& name = study_command.name;
  CLI::App* command = bench.add_subcommand(name, study_command.help);
  command->add_option("-o,--out,--output", flags->out, "folder for " + name + ".json, .csv, .html and the runs")->required()->type_name("DIR");
  command->add_option("--survey", flags->survey, "folder with photos, a simulated survey, or a prepared project")->type_name("FOLDER");
  AddPlaceFlag(
      *command, "--place", [flags](const std::string& place) { flags->place = place; },
      "simulated place to use instead of photos; default: " + study_command.place);
  command->add_option("--model", flags->model, "camera model of the photos, as for prepare; without it COLMAP is run")->type_name("PATH");
  command->add_option("--time-budget", flags->budget, "training time of every variant, such as 90s or 10min; default: " + study_command.budget)
      ->type_name("TIME");
  command
      ->add_option("--seeds", flags->seeds,
                   std::string(study_command.seeds_of_places ? "seeds of training and of the simulated place" : "seeds of training") +
                       ": every variant is trained once with each; default: that of the settings, 1")
      ->delimiter(',')
      ->check(CLI::NonNegativeNumber)
      ->type_name("N,...");
  command->add_flag("--quick", flags->quick, "test with a hamlet and small photos: seconds instead of minutes, figures without meaning");
  command->add_flag("--restart", flags->restart, "remove earlier runs in the output folder first");
  command->add_flag("--keep", flags->keep, "keep checkpoints and scenes of finished variants");
  command->add_flag("--json", flags->json, "print JSON instead of the tables");
  if (study_command.options) study_command.options(command, flags.get());
  command->footer(study_command.footer);
  command->callback([&state, flags, study_command] {
    state.run_command = [&state, flags, study_command] {
      CheckSeeds(*flags);
      if (study_command.check) study_command.check(*flags);
      bench::Study study = Begin(state, *flags, study_command);
      WriteResults(study_command.run(study, *flags), study, state, *flags);
    };
  });
}

}  // namespace skyquilt::app
