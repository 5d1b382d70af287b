// skyquilt_bench_kernels: benchmarks of single kernels on one thread. The options are those of Google Benchmark (--help), for instance
//   skyquilt_bench_kernels --benchmark_filter=Hash --benchmark_repetitions=5
//   SKYQUILT_ISA=avx2 skyquilt_bench_kernels      on another instruction set: avx512, avx2, portable or one by name
#include <benchmark/benchmark.h>

#include <cstdlib>
#include <iostream>
#include <stdexcept>

#include "core/kernel/kernels.h"

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  if (const char* isa = std::getenv("SKYQUILT_ISA"); isa != nullptr && *isa != '\0') {
    try {
      skyquilt::kernel::ForceInstructionSet(isa);
    } catch (const std::invalid_argument& error) {
      std::cerr << "SKYQUILT_ISA: " << error.what() << "\n";
      return 2;
    }
  }
  benchmark::AddCustomContext("instruction_set", skyquilt::kernel::ActiveInstructionSet());
  // A filter that matches no benchmark is an error.
  const bool any = benchmark::RunSpecifiedBenchmarks() > 0;
  benchmark::Shutdown();
  return any ? 0 : 1;
}
