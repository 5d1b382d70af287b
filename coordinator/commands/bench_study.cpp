#include <CLI/CLI.hpp>
#include <iostream>

#include "coordinator/bench/study/study_benches.h"
#include "coordinator/bench/study/study_tables.h"
#include "coordinator/commands/command.h"
#include "coordinator/duration.h"
#include "core/base/errors.h"
#include "core/base/system.h"

namespace skyquilt::coordinator {
namespace {

struct StudyFlags {
  std::string out, survey, preset, model, budget, blocks;
  bool quick = false, restart = false, keep = false, json = false;
};

// What only costs time in a comparison.
const std::vector<Override> kLean = {{"products.video_seconds", "0"}, {"evaluate.report_photos", "6"}, {"evaluate.report_image_width", "640"}};
// A small invented place, seen in small photos.
const std::vector<Override> kQuick = {{"run.image_width", "320"}, {"evaluate.report_photos", "2"}, {"partition.max_log2_table_size", "15"}};

CLI::App* AddStudyCommand(CLI::App& bench, const std::string& name, const std::string& help, const std::shared_ptr<StudyFlags>& flags,
                          const std::string& preset, const std::string& budget) {
  CLI::App* command = bench.add_subcommand(name, help);
  command->add_option("-o,--output", flags->out, "folder for " + name + ".json, .csv, .html and the runs")->required()->type_name("DIR");
  command->add_option("--survey", flags->survey, "folder with photos, a simulated survey, or a project that was prepared")->type_name("FOLDER");
  command->add_option("--preset", flags->preset, "simulate a place instead; default: " + preset)->type_name("NAME");
  command->add_option("--model", flags->model, "COLMAP model of the photos; without it COLMAP is run")->type_name("FOLDER");
  command->add_option("--time-budget", flags->budget, "training time of every variant, as 90s or 10min; default: " + budget)->type_name("TIME");
  command->add_flag("--quick", flags->quick, "a hamlet in small photos, seconds instead of minutes: shows that it works, decides nothing");
  command->add_flag("--restart", flags->restart, "remove the earlier runs in the folder first");
  command->add_flag("--keep", flags->keep, "keep checkpoints and scenes of finished variants");
  command->add_flag("--json", flags->json, "print JSON instead of the tables");
  return command;
}

double BudgetOf(const StudyFlags& flags, double otherwise_s, double quick_s) {
  if (!flags.budget.empty()) return ParseDurationSeconds(flags.budget);
  return flags.quick ? quick_s : otherwise_s;
}

Study Begin(const CommandState& state, const StudyFlags& flags, const std::string& preset) {
  std::vector<Override> own = kLean;
  if (flags.quick) own.insert(own.end(), kQuick.begin(), kQuick.end());
  // --config and --set come last: what the user says counts.
  Settings settings;
  for (const Override& entry : own) ApplyOverride(settings, entry);
  settings = state.LoadOver(settings);
  StudySurvey survey{.folder = flags.survey, .preset = flags.preset, .model = flags.model};
  if (survey.folder.empty() && survey.preset.empty()) survey.preset = flags.quick ? "hamlet" : preset;
  if (!survey.folder.empty() && !std::filesystem::is_directory(survey.folder)) {
    throw base::InputError(survey.folder, "no such folder", "Give the folder that holds the photos, or a project");
  }
  return Study(*state.comm, {.folder = flags.out,
                             .survey = survey,
                             .settings = settings,
                             .restart = flags.restart,
                             .keep = flags.keep,
                             .quiet = state.quiet,
                             .verbose = state.verbose});
}

void Finish(StudyBench bench, const Study& study, const CommandState& state, const StudyFlags& flags) {
  BenchPage& page = bench.page;
  page.machine = base::MachineDescription();
  page.date = base::UtcTimestamp();
  page.command = state.command_line;
  Settings settings = study.settings();
  const std::string json = StudyJson(page, bench.results, settings.Toml());
  WriteBench(flags.out, page, json);
  std::cout << (flags.json ? json : BenchText(page));
  if (!flags.json) std::cout << "\n" << (std::filesystem::path(flags.out) / (page.name + ".html")).string() << "\n";
}

}  // namespace

void AddStudyBenches(CLI::App& bench, CommandState& state) {
  {
    const auto flags = std::make_shared<StudyFlags>();
    CLI::App* command = AddStudyCommand(bench, "single-vs-multi", "one model of the whole area against one per block", flags, "smallcity", "5min");
    flags->blocks = "3x3";
    command->add_option("--blocks", flags->blocks, "of the divided variants, rows x columns")->type_name("RxC")->capture_default_str();
    command->footer(
        "Examples:\n"
        "  skyquilt bench single-vs-multi -o out/bench\n"
        "  skyquilt bench single-vs-multi --survey photos/ --model sparse/0 --time-budget 10min -o out/bench\n"
        "Interrupted, the same command goes on with the variant it was at.");
    command->callback([&state, flags] {
      state.chosen = [&state, flags] {
        Study study = Begin(state, *flags, "smallcity");
        if (flags->quick && flags->blocks == "3x3") flags->blocks = "2x2";
        Finish(SingleVsMulti(study, {.blocks = flags->blocks, .budget_s = BudgetOf(*flags, 300.0, 20.0)}), study, state, *flags);
      };
    });
  }
  {
    const auto flags = std::make_shared<StudyFlags>();
    CLI::App* command = AddStudyCommand(bench, "blocks", "number of blocks against the size of each", flags, "town", "3min");
    command->footer(
        "Examples:\n"
        "  skyquilt bench blocks -o out/bench\n"
        "  skyquilt bench blocks --quick -o out/bench");
    command->callback([&state, flags] {
      state.chosen = [&state, flags] {
        Study study = Begin(state, *flags, "town");
        BlocksBenchOptions options;
        options.budget_s = BudgetOf(*flags, options.budget_s, 10.0);
        if (flags->quick) {
          options.per_side = {1, 2, 3};
          options.log2_table_sizes = {12, 15};
        }
        Finish(BlocksBench(study, options), study, state, *flags);
      };
    });
  }
  {
    const auto flags = std::make_shared<StudyFlags>();
    CLI::App* command = AddStudyCommand(bench, "encodings", "hash grid, voxels, planes and frequencies in the same field", flags, "town", "3min");
    command->footer(
        "Examples:\n"
        "  skyquilt bench encodings -o out/bench\n"
        "  skyquilt bench encodings --quick -o out/bench");
    command->callback([&state, flags] {
      state.chosen = [&state, flags] {
        Study study = Begin(state, *flags, "town");
        EncodingsOptions options;
        options.budget_s = BudgetOf(*flags, options.budget_s, 20.0);
        Finish(EncodingsBench(study, options), study, state, *flags);
      };
    });
  }
  {
    const auto flags = std::make_shared<StudyFlags>();
    CLI::App* command =
        AddStudyCommand(bench, "tradeoff", "what time, tables, samples, photos and precision buy", flags, "town", "45s, 2min and 6min");
    command->footer(
        "Examples:\n"
        "  skyquilt bench tradeoff -o out/bench\n"
        "  skyquilt bench tradeoff --survey out/brighton --time-budget 3min -o out/bench\n"
        "--time-budget sets the middle one of three budgets; the others are a third and three times it.");
    command->callback([&state, flags] {
      state.chosen = [&state, flags] {
        Study study = Begin(state, *flags, "town");
        TradeoffOptions options;
        options.middle_budget_s = BudgetOf(*flags, options.middle_budget_s, 8.0);
        if (flags->quick || !flags->budget.empty()) {
          options.budgets_s = {options.middle_budget_s / 3.0, options.middle_budget_s, 3.0 * options.middle_budget_s};
        }
        if (flags->quick) {
          options.budgets_s.pop_back();
          options.log2_table_sizes = {12, 15};
          options.steps_per_voxel = {2.0, 4.0};
          options.keep_every = {1, 2};
        }
        Finish(Tradeoff(study, options), study, state, *flags);
      };
    });
  }
}

}  // namespace skyquilt::coordinator
