// While it exists, only warnings and errors are logged, and no progress is shown. For cases that run the whole pipeline.
#pragma once

#include <algorithm>

#include "core/base/log.h"
#include "core/base/progress.h"

namespace skyquilt::bench {

class QuietStages {
 public:
  // always: keep progress hidden afterwards too.
  explicit QuietStages(bool always) : always_(always), level_(base::GetLogLevel()) {
    base::SetLogLevel(std::max(level_, base::LogLevel::kWarning));
    base::Progress::SetQuiet(true);
  }
  ~QuietStages() {
    base::SetLogLevel(level_);
    base::Progress::SetQuiet(always_);
  }
  QuietStages(const QuietStages&) = delete;
  QuietStages& operator=(const QuietStages&) = delete;

 private:
  bool always_;
  base::LogLevel level_;
};

}  // namespace skyquilt::bench
