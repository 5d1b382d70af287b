// Entry point of the program: parses the command line, runs one command and turns errors into exit statuses.
#pragma once

#include <functional>

#include "app/commands/command.h"

namespace skyquilt::app {

// Runs the body of a command. An exception becomes an error line and the exit status:
// 0 done; 1 a bug or out of memory; 2 usage or configuration; 3 input data; 4 a block failed; 5 a check of a bench failed; 130 interrupted.
int Guarded(const std::function<void()>& body);
// Adds the command `bench` to a parser.
using AddBenchCommand = void (*)(CLI::App& app, CommandState& state);
// Under mpirun, rank 0 runs the command and the other ranks work for it; they always return 0. add_bench: of the program that has
// `bench`; null: of another one, skyquilt-bench in the same folder, by which this process is then replaced.
int RunCommandLine(int argc, char** argv, AddBenchCommand add_bench = nullptr);

}  // namespace skyquilt::app
