// Options of section [masks] of the configuration: masks that are made of a prepared survey. Fields() describes each one.
#pragma once

#include <string>
#include <vector>

#include "core/config/options.h"

namespace skyquilt::masks {

struct MaskOptions {
  std::string segment;
  std::string segment_config;
  std::string ignore_ground;

  // Whether any masks are made.
  bool Any() const { return !segment.empty() || !ignore_ground.empty(); }

  static std::vector<config::Field<MaskOptions>> Fields();
  // Throws base::UsageError when one of network and configuration is given without the other.
  void Check() const;
};

}  // namespace skyquilt::masks
