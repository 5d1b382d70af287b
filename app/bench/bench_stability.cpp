#include <CLI/CLI.hpp>
#include <iostream>

#include "app/bench/bench_commands.h"
#include "app/commands/command.h"
#include "app/settings/duration.h"
#include "bench/study/stability_bench.h"
#include "bench/study/study_tables.h"
#include "core/base/errors.h"

namespace skyquilt::app {
namespace {

struct StabilityFlags {
  std::string out;
  std::vector<std::string> places, surveys, budgets;
  bench::StabilityOptions options;
  bool no_extremes = false, quick = false, restart = false, json = false;
};

// Small photos and batches: many steps in a short time.
const std::vector<config::Override> kShort = {
    {"run.image_width", "480"},   {"train.batch_samples", "2048"}, {"context.batch_samples", "2048"},     {"products.preview", "false"},
    {"evaluate.max_photos", "6"}, {"evaluate.report_photos", "1"}, {"evaluate.report_image_width", "320"}};

struct NamedSurvey {
  std::string name;
  bench::StudySurvey source;
};

// NAME=FOLDER or NAME=FOLDER,MODEL.
NamedSurvey ParseSurvey(const std::string& text) {
  const size_t equals = text.find('='), comma = text.find(',', equals == std::string::npos ? 0 : equals);
  if (equals == std::string::npos || equals == 0) throw base::UsageError("--survey " + text + ": give NAME=FOLDER or NAME=FOLDER,MODEL");
  NamedSurvey survey{text.substr(0, equals), {}};
  survey.source.folder = text.substr(equals + 1, comma == std::string::npos ? std::string::npos : comma - equals - 1);
  if (comma != std::string::npos) survey.source.model = text.substr(comma + 1);
  if (!std::filesystem::is_directory(survey.source.folder)) {
    throw base::InputError(survey.source.folder, "no such folder", "Give the folder that holds the photos, or a project");
  }
  return survey;
}

void RunStability(const CommandState& state, StabilityFlags flags) {
  if (!flags.budgets.empty()) flags.options.budgets_s.clear();
  for (const std::string& budget : flags.budgets) flags.options.budgets_s.push_back(ParseDurationSeconds(budget));
  if (flags.no_extremes) flags.options.extremes.clear();
  if (flags.quick) {
    flags.options.blocks = {"1x1", "2x2"};
    flags.options.seeds = {1};
    flags.options.rates = {1.0, 4.0};
    if (flags.budgets.empty()) flags.options.budgets_s = {4.0};
    if (flags.places.empty() && flags.surveys.empty()) flags.places = {"hamlet"};
  }
  if (flags.places.empty() && flags.surveys.empty()) flags.places = {"hamlet", "town", "tidalflat", "solar_farm"};
  std::vector<NamedSurvey> surveys;
  for (const std::string& text : flags.surveys) surveys.push_back(ParseSurvey(text));
  for (const std::string& place : flags.places) surveys.push_back({place, {.folder = "", .place = place, .model = ""}});
  coordinator::Settings settings;
  for (const config::Override& entry : kShort) settings.Set(entry);
  settings = state.LoadOver(settings);
  std::vector<bench::StabilityRun> runs;
  std::vector<bench::VariantResult> results;
  for (const NamedSurvey& survey : surveys) {
    bench::Study study(*state.comm, {.folder = std::filesystem::path(flags.out) / survey.name,
                                     .survey = survey.source,
                                     .settings = settings,
                                     .restart = flags.restart,
                                     .quiet = state.quiet,
                                     .verbose = state.verbose});
    for (bench::StabilityRun& run : bench::RunStability(study, survey.name, flags.options)) {
      results.push_back(run.result);
      runs.push_back(std::move(run));
    }
  }
  bench::BenchPage page = bench::StabilityPage(runs);
  page.SetOrigin(state.command_line);
  const std::string json = bench::StudyJson(page, results, settings.Toml());
  bench::WriteBench(flags.out, page, json);
  std::cout << (flags.json ? json : bench::BenchText(page));
  if (!flags.json) std::cout << "\n" << (std::filesystem::path(flags.out) / (page.name + ".html")).string() << "\n";
}

}  // namespace

void AddStabilityBench(CLI::App& bench, CommandState& state) {
  const auto flags = std::make_shared<StabilityFlags>();
  bench::StabilityOptions& o = flags->options;
  CLI::App* command =
      bench.add_subcommand("stability", "look for trainings that fall apart: surveys over blocks, seeds, learning rates and extremes");
  command->add_option("-o,--out,--output", flags->out, "folder for stability.json, .csv, .html and the runs")->required()->type_name("DIR");
  command->add_option("--places", flags->places, "simulated places; default: hamlet,town,tidalflat,solar_farm, or none when --survey is given")
      ->delimiter(',')
      ->type_name("NAME,...");
  command->add_option("--survey", flags->surveys, "photos to train as well, with their camera model or without; may be given several times")
      ->type_name("NAME=FOLDER[,MODEL]");
  command->add_option("--blocks", o.blocks, "layouts of blocks, as for partition; default: auto,1x1,4x4")->delimiter(',')->type_name("RxC,...");
  command->add_option("--seeds", o.seeds, "seeds of training; default: 1,2")->delimiter(',')->check(CLI::NonNegativeNumber)->type_name("N,...");
  command->add_option("--rates", o.rates, "factors on the learning rate; default: 1,2,4")
      ->delimiter(',')
      ->check(CLI::PositiveNumber)
      ->type_name("X,...");
  command->add_option("--time-budget", flags->budgets, "training times of every run; default: 20s")->delimiter(',')->type_name("TIME,...");
  std::string names;
  for (const std::string& name : bench::StabilityExtremes()) names += (names.empty() ? "" : ", ") + name;
  command->add_option("--extremes", o.extremes, "each is trained once: " + names + "; default: all")
      ->delimiter(',')
      ->check(CLI::IsMember(bench::StabilityExtremes()))
      ->type_name("NAME,...");
  command->add_flag("--no-extremes", flags->no_extremes, "train no extremes");
  command->add_flag("--quick", flags->quick, "test with a hamlet: some minutes, figures without meaning");
  command->add_flag("--restart", flags->restart, "remove earlier runs in the output folder first");
  command->add_flag("--json", flags->json, "print JSON instead of the tables");
  command->footer(
      "Examples:\n"
      "  skyquilt bench stability -o out/stability\n"
      "  skyquilt bench stability -o out/stability --survey farm=photos,sparse/0 --rates 1,2 --time-budget 20s,3min\n"
      "After an interruption, the same command continues with the unfinished run.");
  command->callback([&state, flags] { state.run_command = [&state, flags] { RunStability(state, *flags); }; });
}

}  // namespace skyquilt::app
