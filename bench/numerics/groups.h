// The groups of numerical checks, one function each.
#pragma once

#include <filesystem>

#include "bench/numerics/numeric_case.h"
#include "core/comm/communicator.h"

namespace skyquilt::bench {

struct NumericsOptions {
  bool quick = false;
  bool silent = false;                 // show no progress
  int threads = 0;                     // 0: all cores
  std::filesystem::path work_folder;   // for the surveys that cases make; no other files may be in it
  comm::Communicator* comm = nullptr;  // for cases that run the whole pipeline; null: they are left out
};

NumericGroup SpaceGroup(const NumericsOptions& options);
NumericGroup RayGroup(const NumericsOptions& options);
NumericGroup CompositeGroup(const NumericsOptions& options);
NumericGroup FieldGroup(const NumericsOptions& options);
NumericGroup TrainerGroup(const NumericsOptions& options);
NumericGroup ConesGroup(const NumericsOptions& options);
NumericGroup PriorsGroup(const NumericsOptions& options);
NumericGroup AwayGroup(const NumericsOptions& options);
NumericGroup BrightnessGroup(const NumericsOptions& options);
NumericGroup NonFiniteGroup(const NumericsOptions& options);
NumericGroup StorageGroup(const NumericsOptions& options);
NumericGroup PlaceGroup(const NumericsOptions& options);
NumericGroup TilesGroup(const NumericsOptions& options);
NumericGroup EarthGroup(const NumericsOptions& options);

}  // namespace skyquilt::bench
