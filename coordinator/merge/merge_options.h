// [merge] in the configuration.
#pragma once

#include <string>

#include "core/checkpoint/archive.h"
#include "core/config/options.h"
#include "core/render/scene.h"

namespace skyquilt::coordinator {

struct MergeOptions {
  std::string borders = "smooth";
  std::string storage = "fp32";

  void Visit(config::OptionVisitor& v);
  // Throws base::UsageError naming the option and what it may be.
  void Check() const;
  checkpoint::Precision Storage() const;
  render::Borders Borders() const { return borders == "hard" ? render::Borders::kHard : render::Borders::kSmooth; }
};

}  // namespace skyquilt::coordinator
