#include "coordinator/commands/cli.h"

int main(int argc, char** argv) {
  return skyquilt::coordinator::RunCommandLine(argc, argv);
}
