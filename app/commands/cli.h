// The command line as a whole: parses it, runs one command, turns errors into exit statuses.
#pragma once

#include <functional>

namespace skyquilt::app {

// Runs the body of a command: what it throws becomes an error line and the exit status.
// 0 done; 1 a bug of ours; 2 usage or configuration; 3 input data; 4 a block failed; 5 a bench found a promise broken; 130 interrupted.
int Guarded(const std::function<void()>& body);
// Under an MPI launcher rank 0 runs the command and the other ranks serve it; those always return 0.
int RunCommandLine(int argc, char** argv);

}  // namespace skyquilt::app
