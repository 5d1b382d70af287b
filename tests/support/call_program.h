// Runs a command line of the program, with its benchmarks unless add_bench is null, inside the test's process, and captures its output.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "app/bench/bench_commands.h"
#include "app/commands/cli.h"

namespace skyquilt {

struct Called {
  int status = 0;
  std::string out;
  std::string err;
};

inline Called CallProgram(std::vector<std::string> words, app::AddBenchCommand add_bench = app::AddBench) {
  words.insert(words.begin(), "skyquilt");
  std::vector<char*> argv;
  argv.reserve(words.size());
  for (std::string& word : words) argv.push_back(word.data());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Called called;
  called.status = app::RunCommandLine(static_cast<int>(argv.size()), argv.data(), add_bench);
  called.out = testing::internal::GetCapturedStdout();
  called.err = testing::internal::GetCapturedStderr();
  return called;
}

}  // namespace skyquilt
