// The command `bench` and what its subcommands share.
#pragma once

#include "app/commands/command.h"

namespace skyquilt::app {

// The value of --threads; 0: all cores. Throws base::UsageError when it is not a whole number.
int BenchThreads(const CommandState& state);

void AddBench(CLI::App& app, CommandState& state);
// The subcommands that train whole surveys.
void AddStudyBenches(CLI::App& bench, CommandState& state);
// One of them, which they add themselves.
void AddLightBench(CLI::App& bench, CommandState& state);
void AddMethodsBench(CLI::App& bench, CommandState& state);
void AddNumericsBench(CLI::App& bench, CommandState& state);
void AddPosesBench(CLI::App& bench, CommandState& state);
void AddScaleBench(CLI::App& bench, CommandState& state);
void AddSeedingBench(CLI::App& bench, CommandState& state);
void AddStabilityBench(CLI::App& bench, CommandState& state);

}  // namespace skyquilt::app
