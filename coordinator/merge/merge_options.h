// [merge] in the configuration.
#pragma once

#include <string>

#include "core/config/options.h"
#include "core/render/scene.h"

namespace skyquilt::coordinator {

struct MergeOptions {
  std::string borders = "smooth";

  void Visit(config::OptionVisitor& v);
  // Throws base::UsageError naming the option and what it may be.
  void Check() const;
  render::Borders Borders() const { return borders == "hard" ? render::Borders::kHard : render::Borders::kSmooth; }
};

}  // namespace skyquilt::coordinator
