#include <CLI/CLI.hpp>
#include <algorithm>

#include "app/bench/bench_commands.h"
#include "app/bench/study_command.h"
#include "app/settings/duration.h"
#include "app/settings/presets.h"
#include "bench/study/study_benches.h"
#include "core/base/errors.h"
#include "partition/block_grid.h"

namespace skyquilt::app {
namespace {

bench::StudyBench RunSingleVsMulti(bench::Study& study, const StudyFlags& flags) {
  const bool smaller = flags.quick && flags.blocks.empty();
  bench::SingleVsMultiOptions options;
  options.budget_s = BudgetOf(flags, options.budget_s, 20.0);
  if (smaller) options.blocks = "2x2";
  if (!flags.blocks.empty()) options.blocks = flags.blocks;
  study.UseSeeds(flags.seeds);
  return bench::SingleVsMulti(study, options);
}

bench::StudyBench RunBlocks(bench::Study& study, const StudyFlags& flags) {
  bench::BlocksBenchOptions options;
  options.budget_s = BudgetOf(flags, options.budget_s, 10.0);
  options.steps = flags.steps;
  if (flags.quick) {
    options.blocks = {"1x1", "2x2", "3x3"};
    options.log2_table_sizes = {12, 15};
  }
  if (!flags.divisions.empty()) options.blocks = flags.divisions;
  if (!flags.log2_table_sizes.empty()) options.log2_table_sizes = flags.log2_table_sizes;
  study.UseSeeds(flags.seeds);
  return bench::BlocksBench(study, options);
}

bench::StudyBench RunCapacity(bench::Study& study, const StudyFlags& flags) {
  bench::CapacityOptions options;
  options.budget_s = BudgetOf(flags, options.budget_s, 15.0);
  options.blocks = flags.blocks;
  if (flags.quick) options.log2_table_sizes = {13, 15};
  if (!flags.log2_table_sizes.empty()) options.log2_table_sizes = flags.log2_table_sizes;
  if (!flags.voxels_per_entry.empty()) options.voxels_per_entry = flags.voxels_per_entry;
  study.UseSeeds(flags.seeds);
  return bench::CapacityBench(study, options);
}

bench::StudyBench RunEncodings(bench::Study& study, const StudyFlags& flags) {
  bench::EncodingsOptions options;
  options.budget_s = BudgetOf(flags, options.budget_s, 20.0);
  study.UseSeeds(flags.seeds);
  return bench::EncodingsBench(study, options);
}

bench::StudyBench RunWithinTotals(bench::Study& study, const StudyFlags& flags) {
  bench::WithinOptions options;
  for (const std::string& text : flags.within) options.totals_s.push_back(ParseDurationSeconds(text));
  std::sort(options.totals_s.begin(), options.totals_s.end());
  for (const std::string& name : QualityPresets()) {
    if (!flags.quick || name == "fast") options.presets.push_back({name, PresetOverrides(name), {}});
  }
  return bench::TradeoffWithin(study, options);
}

void CheckWithin(const StudyFlags& flags) {
  for (const std::string& text : flags.within) ParseDurationSeconds(text);
  if (flags.within.empty()) return;
  if (!flags.budget.empty())
    throw base::UsageError("--within and --time-budget exclude each other: one is the time for everything, one that of training");
  if (!flags.seeds.empty()) throw base::UsageError("--within takes no --seeds: give another seed with --set run.seed=N and another folder");
}

void AddWithinTotals(CLI::App* command, StudyFlags* flags) {
  command
      ->add_option("--within", flags->within,
                   "instead: compare presets by the clock, each within these total times from photos to report, such as 2min,5min,10min,30min,2h")
      ->delimiter(',')
      ->type_name("TIME,...");
}

bench::StudyBench RunTradeoff(bench::Study& study, const StudyFlags& flags) {
  if (!flags.within.empty()) return RunWithinTotals(study, flags);
  bench::TradeoffOptions options;
  const std::map<std::string, std::vector<double>> made_for = {
      {"fast", {1.0 / 3.0, 1.0, 3.0}}, {"default", {1.0 / 3.0, 1.0, 3.0, 9.0}}, {"quality", {1.0, 3.0, 9.0}}};
  for (const std::string& name : QualityPresets()) options.presets.push_back({name, PresetOverrides(name), made_for.at(name)});
  options.middle_budget_s = BudgetOf(flags, options.middle_budget_s, 8.0);
  if (flags.quick) {
    // Two points of one curve, one of the others.
    for (bench::StudiedPreset& preset : options.presets) preset.budgets = {1.0};
    options.presets.front().budgets = {1.0 / 3.0, 1.0};
    options.log2_table_sizes = {12, 15};
    options.step_voxels = {4.0};
    options.every_nth_photo = {1, 2};
  }
  study.UseSeeds(flags.seeds);
  return bench::Tradeoff(study, options);
}

bool Asked(const StudyFlags& flags, const char* part) {
  return std::find(flags.parts.begin(), flags.parts.end(), part) != flags.parts.end();
}

void CheckScales(const StudyFlags& flags) {
  if (Asked(flags, "heights") && !flags.survey.empty()) {
    throw base::UsageError("part 'heights' simulates its photos, so it needs --place NAME instead of --survey");
  }
}

bench::StudyBench RunScales(bench::Study& study, const StudyFlags& flags) {
  bench::ScalesOptions options;
  options.budget_s = BudgetOf(flags, options.budget_s, 4.0);
  options.seeds = flags.seeds;
  options.equal_time = Asked(flags, "time");
  options.equal_steps = Asked(flags, "steps");
  options.heights = Asked(flags, "heights");
  if (flags.quick) {
    options.positions = {0, 1};
    options.place = "hamlet";
    options.height_views = 3;
  }
  if (!flags.place.empty()) options.place = flags.place;
  if (!flags.positions.empty()) options.positions = flags.positions;
  return bench::ScalesBench(study, options);
}

// The options that only `bench scales` has.
void AddScalesOptions(CLI::App* command, StudyFlags* flags) {
  command
      ->add_option("--positions", flags->positions,
                   "kinds of samples to compare: 0 are points, others cones with so many positions; default: 0,1,4,6, with --quick 0,1")
      ->delimiter(',')
      ->check(CLI::IsMember({0, 1, 4, 6}))
      ->type_name("N,...");
  command->add_option("--parts", flags->parts, "comparisons: time, steps, heights; default: time,steps")
      ->delimiter(',')
      ->check(CLI::IsMember({"time", "steps", "heights"}))
      ->type_name("PART,...");
}

bench::StudyBench RunPriors(bench::Study& study, const StudyFlags& flags) {
  bench::PriorsOptions options;
  options.variants = flags.variants;
  options.budget_s = BudgetOf(flags, options.budget_s, 4.0);
  options.seeds = flags.seeds;
  return bench::PriorsBench(study, options);
}

// The study simulates the place of the first seed.
std::vector<config::Override> FirstPlace(const StudyFlags& flags) {
  if (flags.seeds.empty() || !flags.survey.empty()) return {};
  return {{"simulate.seed", std::to_string(flags.seeds.front())}};
}

bench::StudyBench RunBuildings(bench::Study& study, const StudyFlags& flags) {
  bench::BuildingsBenchOptions options;
  options.variants = flags.variants;
  options.budget_s = BudgetOf(flags, options.budget_s, 4.0);
  options.seeds = flags.seeds;
  return bench::BuildingsBench(study, options);
}

void CheckBuildings(const StudyFlags& flags) {
  if (!flags.shapes.empty() && !flags.survey.empty()) {
    throw base::UsageError("--shapes is for a simulated place, so it needs --place NAME instead of --survey");
  }
}

std::vector<config::Override> TownsOf(const StudyFlags& flags) {
  std::vector<config::Override> overrides = FirstPlace(flags);
  if (!flags.shapes.empty()) overrides.push_back({"simulate.building_shapes", flags.shapes});
  return overrides;
}

// The options that only `bench buildings` has.
void AddBuildingsOptions(CLI::App* command, StudyFlags* flags) {
  std::string names;
  for (const std::string& name : bench::BuildingsVariantNames()) names += (names.empty() ? "" : ", ") + name;
  command->add_option("--variants", flags->variants, "sources of the surface to compare: " + names + "; default: all")
      ->delimiter(',')
      ->check(CLI::IsMember(bench::BuildingsVariantNames()))
      ->type_name("NAME,...");
  command->add_option("--shapes", flags->shapes, "shapes of the simulated buildings: plain or varied; default: that of the settings, plain")
      ->check(CLI::IsMember({"plain", "varied"}))
      ->type_name("NAME");
}

// The options that only `bench priors` has.
void AddPriorsOptions(CLI::App* command, StudyFlags* flags) {
  std::string names;
  for (const bench::StudiedPrior& prior : bench::StudiedPriors()) names += ", " + prior.name;
  command->add_option("--priors", flags->variants, "variants to train: none (always)" + names + ", all, default; default: all of these")
      ->delimiter(',')
      ->check(CLI::IsMember(bench::PriorVariantNames()))
      ->type_name("NAME,...");
}

void AddTableSizes(CLI::App* command, const std::string& help, StudyFlags* flags) {
  command->add_option("--log2-table-sizes", flags->log2_table_sizes, help)->delimiter(',')->check(CLI::Range(4, 24))->type_name("N,...");
}

// The options that only `bench blocks` has.
void AddBlocksOptions(CLI::App* command, StudyFlags* flags) {
  command->add_option("--blocks", flags->divisions, "rows x columns to compare; default: 1x1,2x2,2x4,4x4, with --quick 1x1,2x2,3x3")
      ->delimiter(',')
      ->type_name("RxC,...");
  AddTableSizes(command, "table sizes to compare: log2 of the entries per level; default: 15,17,19, with --quick 12,15", flags);
  command
      ->add_option("--steps", flags->steps,
                   "steps of context and blocks together instead of a time, the same for every variant: for machines with other work")
      ->check(CLI::Range(1, 1000000000))
      ->type_name("N");
}

void CheckBlocks(const StudyFlags& flags) {
  if (flags.steps > 0 && !flags.budget.empty())
    throw base::UsageError("--steps and --time-budget exclude each other: every variant gets the one or the other");
  for (const std::string& blocks : flags.divisions) {
    if (partition::ParseBlockRequest(blocks).kind != partition::BlockRequestKind::kCount)
      throw base::UsageError("--blocks " + blocks + ": give rows x columns, such as 1x1,2x2,4x4");
  }
}

}  // namespace

void AddStudyBenches(CLI::App& bench, CommandState& state) {
  AddStudyCommand(
      bench, state,
      {.name = "single-vs-multi",
       .help = "compare one model of the whole area with one model per block",
       .place = "smallcity",
       .budget = "5min",
       .footer = "Examples:\n"
                 "  skyquilt bench single-vs-multi -o out/bench\n"
                 "  skyquilt bench single-vs-multi --survey photos/ --model sparse/0 --time-budget 10min -o out/bench\n"
                 "After an interruption, the same command continues with the unfinished variant.",
       .options =
           [](CLI::App* command, StudyFlags* flags) {
             command->add_option("--blocks", flags->blocks, "rows x columns of the variants with several blocks; default: 3x3, with --quick 2x2")
                 ->type_name("RxC");
           },
       .run = RunSingleVsMulti});
  AddStudyCommand(bench, state,
                  {.name = "blocks",
                   .help = "compare numbers of blocks and table sizes",
                   .place = "town",
                   .budget = "3min",
                   .footer = "Examples:\n"
                             "  skyquilt bench blocks -o out/bench\n"
                             "  skyquilt bench blocks --seeds 1,2,3 -o out/bench\n"
                             "  skyquilt --config instant-ngp bench blocks --blocks 1x1,4x4 --steps 4000 -o out/bench",
                   .options = AddBlocksOptions,
                   .check = CheckBlocks,
                   .run = RunBlocks});
  AddStudyCommand(
      bench, state,
      {.name = "capacity",
       .help = "compare table sizes chosen per block with one size for all blocks",
       .place = "smallcity",
       .budget = "5min",
       .footer = "Examples:\n"
                 "  skyquilt bench capacity -o out/bench\n"
                 "  skyquilt bench capacity --survey photos/ --model sparse/0 --blocks 3x3 -o out/bench",
       .options =
           [](CLI::App* command, StudyFlags* flags) {
             command->add_option("--blocks", flags->blocks, "rows x columns; default: as `partition` chooses")->type_name("RxC");
             AddTableSizes(command,
                           "table sizes of the variants with one size for all blocks: log2 of the entries per level; default: 17,18, "
                           "with --quick 13,15",
                           flags);
             command->add_option("--voxels-per-entry", flags->voxels_per_entry, "finest voxels on the surface per table entry; default: 1,2,8")
                 ->delimiter(',')
                 ->check(CLI::Range(0.1, 1000.0))
                 ->type_name("X,...");
           },
       .run = RunCapacity});
  AddStudyCommand(bench, state,
                  {.name = "encodings",
                   .help = "compare encodings in the same field: hash grid, voxels, planes, frequencies",
                   .place = "town",
                   .budget = "3min",
                   .footer = "Examples:\n"
                             "  skyquilt bench encodings -o out/bench\n"
                             "  skyquilt bench encodings --quick -o out/bench",
                   .run = RunEncodings});
  AddLightBench(bench, state);
  AddMethodsBench(bench, state);
  AddStudyCommand(bench, state,
                  {.name = "tradeoff",
                   .help = "measure how time, table size, samples, photos and precision change the quality",
                   .place = "town",
                   .budget = "1min",
                   .footer = "Examples:\n"
                             "  skyquilt bench tradeoff -o out/bench\n"
                             "  skyquilt bench tradeoff --survey out/brighton --time-budget 3min -o out/bench\n"
                             "  skyquilt bench tradeoff --survey photos/ --within 2min,5min,10min,30min -o out/bench\n"
                             "--time-budget is the training time of variants that change one setting. Presets are trained for a third of it up to\n"
                             "nine times as long. With --within, only presets are compared, by all the time from photos to report.",
                   .options = AddWithinTotals,
                   .check = CheckWithin,
                   .run = RunTradeoff});
  AddStudyCommand(bench, state,
                  {.name = "scales",
                   .help = "compare points with cones, trained with photos or a pyramid of them, on renderings of several widths",
                   .place = "town",
                   .budget = "1min",
                   .footer = "Examples:\n"
                             "  skyquilt bench scales -o out/bench\n"
                             "  skyquilt bench scales --survey photos/ --model sparse/0 --parts time --seeds 1,2,3 -o out/bench\n"
                             "  skyquilt bench scales --parts heights -o out/bench\n"
                             "Also writes scales.png with crops side by side. After an interruption, the same command continues.",
                   .options = AddScalesOptions,
                   .check = CheckScales,
                   .run = RunScales});
  AddStudyCommand(bench, state,
                  {.name = "priors",
                   .help = "compare losses that say what surfaces usually are: none, each alone, all",
                   .place = "town",
                   .budget = "90s",
                   .footer = "Examples:\n"
                             "  skyquilt bench priors -o out/bench\n"
                             "  skyquilt bench priors --priors planar,upright,all --seeds 11,12,13 -o out/bench\n"
                             "  skyquilt bench priors --survey photos/ --model sparse/0 -o out/bench\n"
                             "Also writes priors.png with crops side by side. After an interruption, the same command continues; seeds may be added\n"
                             "behind the first.",
                   .seeds_of_places = true,
                   .options = AddPriorsOptions,
                   .overrides = FirstPlace,
                   .run = RunPriors});
  AddStudyCommand(bench, state,
                  {.name = "buildings",
                   .help = "compare how well buildings are found and measured: from true depth, sparse points and fields",
                   .place = "town",
                   .budget = "90s",
                   .footer = "Examples:\n"
                             "  skyquilt bench buildings -o out/bench\n"
                             "  skyquilt bench buildings --seeds 11,12,13 --shapes varied -o out/bench\n"
                             "The survey must be simulated. After an interruption, the same command continues; seeds may be added behind the first.",
                   .seeds_of_places = true,
                   .options = AddBuildingsOptions,
                   .overrides = TownsOf,
                   .check = CheckBuildings,
                   .run = RunBuildings});
}

}  // namespace skyquilt::app
