// What the subcommands of `bench` that train whole surveys share: their options, and from the settings to the written pages.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "app/commands/command.h"
#include "bench/study/study_benches.h"

namespace skyquilt::app {

struct StudyFlags {
  std::string out, survey, place, model, budget, blocks;
  std::vector<int> log2_table_sizes;     // empty: the study's own
  std::vector<double> voxels_per_entry;  // empty: the study's own
  std::vector<int> positions;            // empty: the study's own
  std::vector<std::string> parts = {"time", "steps"};
  std::vector<std::string> variants;   // of --priors, --variants and --methods; empty: all
  std::vector<std::string> within;     // of tradeoff: total times; empty: training times are studied
  std::vector<std::string> divisions;  // of blocks: rows x columns; empty: the study's own
  int steps = 0;                       // of blocks, of light and of methods with a data set, in place of the time; 0: by time
  std::string data, pictures;          // of methods: a published data set, and its folder of pictures
  std::string shapes;                  // empty: the settings' own
  std::vector<double> overlaps;        // of methods; empty: the settings' own
  std::vector<double> altitudes;       // of methods; empty: the settings' own
  std::vector<int> seeds;              // empty: the settings' own
  bool quick = false, restart = false, keep = false, json = false;
};

struct StudyCommand {
  std::string name, help;
  std::string place;   // simulated when no survey is given
  std::string budget;  // default training time, as shown in the help
  std::string footer;
  std::vector<config::Override> defaults = {};                                     // changes to the settings, before --config and --set
  bool seeds_of_places = false;                                                    // --seeds are those of the simulated place, too
  std::function<void(CLI::App*, StudyFlags*)> options = {};                        // adds the options that only this command has
  std::function<std::vector<config::Override>(const StudyFlags&)> overrides = {};  // changes to the settings, after --config and --set
  std::function<void(const StudyFlags&)> check = {};                               // refuses combinations of options before any work
  std::function<bench::StudyBench(bench::Study&, const StudyFlags&)> run;
};

// The training time that was given, else one of the others.
double BudgetOf(const StudyFlags& flags, double otherwise_s, double quick_s);

void AddStudyCommand(CLI::App& bench, CommandState& state, const StudyCommand& study_command);

}  // namespace skyquilt::app
