// The subcommands of `bench` that have a file of their own.
#pragma once

#include "app/commands/command.h"

namespace skyquilt::app {

// Of --threads; 0: every core. Throws base::UsageError.
int BenchThreads(const CommandState& state);

void AddNumericsBench(CLI::App& bench, CommandState& state);

}  // namespace skyquilt::app
