// The groups of cases, one per kind of trouble.
#pragma once

#include <filesystem>

#include "bench/numerics/numeric_case.h"
#include "core/comm/communicator.h"

namespace skyquilt::bench {

struct NumericsOptions {
  bool quick = false;
  bool silent = false;                 // no progress is shown, whatever runs
  int threads = 0;                     // 0: every core
  std::filesystem::path work_folder;   // for surveys that cases make; theirs alone
  comm::Communicator* comm = nullptr;  // of the whole pipeline's runs; null: those are left out
};

NumericGroup SpaceGroup(const NumericsOptions& options);
NumericGroup RayGroup(const NumericsOptions& options);
NumericGroup CompositeGroup(const NumericsOptions& options);
NumericGroup FieldGroup(const NumericsOptions& options);
NumericGroup TrainerGroup(const NumericsOptions& options);
NumericGroup AwayGroup(const NumericsOptions& options);
NumericGroup BrightnessGroup(const NumericsOptions& options);
NumericGroup NonFiniteGroup(const NumericsOptions& options);
NumericGroup StorageGroup(const NumericsOptions& options);
NumericGroup EarthGroup(const NumericsOptions& options);

}  // namespace skyquilt::bench
