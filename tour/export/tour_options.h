// Options of section [tour] of the configuration: tours that are given away as a folder.
#pragma once

#include <cstdint>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::tour {

struct TourOptions {
  int auto_stops = 0;      // stops that 'skyquilt run' proposes where there is no tour; 0: it makes none
  double size_mb = 200.0;  // most of the exported folder, millions of bytes
  int still_width = 1600;  // of the picture that a stop shows, pixels
  int still_height = 900;
  int panorama_width = 4096;  // of the picture of all directions at a stop, twice its height

  int64_t SizeBytes() const { return static_cast<int64_t>(size_mb * 1e6); }

  static std::vector<config::Field<TourOptions>> Fields();
  // Throws base::UsageError that names the option, its value and the rule it breaks.
  void Check() const;
};

}  // namespace skyquilt::tour
