// The command line as a whole: parses it, runs one command, turns errors into exit statuses.
#pragma once

namespace skyquilt::coordinator {

// 0 done; 1 a bug of ours; 2 usage or configuration; 3 input data; 4 a block failed; 130 interrupted.
// Under an MPI launcher rank 0 runs the command and the other ranks serve it; those always return 0.
int RunCommandLine(int argc, char** argv);

}  // namespace skyquilt::coordinator
