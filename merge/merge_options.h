// [merge] in the configuration.
#pragma once

#include <string>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/config/options.h"
#include "core/scene/scene.h"

namespace skyquilt::merge {

struct MergeOptions {
  std::string borders = "smooth";
  std::string storage = "fp32";

  static std::vector<config::Field<MergeOptions>> Fields();
  // Throws base::UsageError naming the option and what it may be.
  void Check() const;
  checkpoint::Precision Storage() const;
  scene::Borders Borders() const { return borders == "hard" ? scene::Borders::kHard : scene::Borders::kSmooth; }
};

}  // namespace skyquilt::merge
