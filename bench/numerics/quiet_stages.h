// While it exists, only warnings and errors are logged, and no progress is shown. For cases that run the whole pipeline.
#pragma once

#include <algorithm>

#include "core/base/log.h"
#include "core/base/progress.h"

namespace skyquilt::bench {

class QuietStages {
 public:
  // always: keep progress hidden afterwards too.
  explicit QuietStages(bool always) : always_(always), level_(spdlog::get_level()) {
    spdlog::set_level(std::max(level_, spdlog::level::warn));
    base::Progress::SetQuiet(true);
  }
  ~QuietStages() {
    spdlog::set_level(level_);
    base::Progress::SetQuiet(always_);
  }
  QuietStages(const QuietStages&) = delete;
  QuietStages& operator=(const QuietStages&) = delete;

 private:
  bool always_;
  spdlog::level::level_enum level_;
};

}  // namespace skyquilt::bench
