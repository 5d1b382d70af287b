// Options of section [merge] of the configuration: how a scene file is made of trained blocks.
#pragma once

#include <string>
#include <vector>

#include "core/checkpoint/archive.h"
#include "core/config/options.h"
#include "core/scene/scene.h"

namespace skyquilt::merge {

struct MergeOptions {
  std::string borders = "smooth";  // "smooth" (blended) or "hard"
  std::string look;                // whose appearance codes the scene shows, see merge/look.h; empty: the mean look
  std::string storage = "fp32";    // of the hash tables: "fp32", "bf16" or "fp16"

  static std::vector<config::Field<MergeOptions>> Fields();
  // Throws base::UsageError that names the option and its allowed values.
  void Check() const;
  checkpoint::Precision Storage() const;
  scene::Borders Borders() const { return borders == "hard" ? scene::Borders::kHard : scene::Borders::kSmooth; }
};

}  // namespace skyquilt::merge
