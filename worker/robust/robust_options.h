// Options of section [robust] of the configuration: pixels of photos that blocks do not learn from because other photos contradict them.
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::worker {

struct RobustOptions {
  std::string movers = "off";  // off, on or auto
  std::string prefer = "any";  // any or latest

  // Whether photos are compared at all.
  bool Any() const { return movers != "off" || prefer != "any"; }

  static std::vector<config::Field<RobustOptions>> Fields();
  // Throws base::UsageError for values that are not allowed.
  void Check() const;
};

}  // namespace skyquilt::worker
