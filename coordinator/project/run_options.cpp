#include "coordinator/project/run_options.h"

#include <cmath>
#include <string>

#include "core/base/errors.h"
#include "core/base/system.h"

namespace skyquilt::coordinator {

void RunOptions::Visit(config::OptionVisitor& v) {
  v.Field("image_width", image_width, "pixels; photos are reduced to this width for training and scoring; 0 = full size");
  v.Field("time_budget_s", time_budget_s,
          "seconds for all training together, shared out over context and blocks; 0 = the steps of [context] and [train] decide");
  v.Field("context_share", context_share, "share of the time budget that the context gets, 0.01 to 0.9");
  v.Field("seed", seed, "start of every random sequence of the training, 0 or more");
  v.Field("threads", threads, "threads per machine; 0 = every core this process may use");
  v.Field("memory_gb", memory_gb,
          "memory per machine that fields and photos may take, in GiB, shared by the ranks on it; 0 = half of the machine. Training refuses to start "
          "with blocks that do not fit, and reads photos' pixels on demand when they do not; rendering loads blocks on demand");
}

int RunOptions::UsableThreads() const {
  return threads > 0 ? threads : base::UsableCores();
}

double RunOptions::MemoryLimitBytes() const {
  return memory_gb > 0.0 ? memory_gb * 1073741824.0 : 0.5 * static_cast<double>(base::TotalMemoryBytes());
}

void RunOptions::Validate() const {
  const auto require = [](bool good, const std::string& key, const std::string& value, const std::string& allowed) {
    if (!good) throw base::UsageError("run." + key + " = " + value + " cannot be: it must be " + allowed);
  };
  require(image_width == 0 || image_width >= 16, "image_width", std::to_string(image_width), "0 (full size) or at least 16 pixels");
  require(std::isfinite(time_budget_s) && time_budget_s >= 0.0, "time_budget_s", std::to_string(time_budget_s), "0 or a positive number of seconds");
  require(context_share >= 0.01 && context_share <= 0.9, "context_share", std::to_string(context_share), "between 0.01 and 0.9");
  require(seed >= 0, "seed", std::to_string(seed), "0 or more");
  require(threads >= 0 && threads <= 4096, "threads", std::to_string(threads), "between 0 and 4096");
  require(std::isfinite(memory_gb) && memory_gb >= 0.0, "memory_gb", std::to_string(memory_gb), "0 or more");
}

}  // namespace skyquilt::coordinator
