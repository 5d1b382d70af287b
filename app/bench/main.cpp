#include "app/bench/bench_commands.h"
#include "app/commands/cli.h"

int main(int argc, char** argv) {
  return skyquilt::app::RunCommandLine(argc, argv, skyquilt::app::AddBench);
}
