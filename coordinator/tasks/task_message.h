// Messages about tasks: the number of a task, a newline, the rest.
#pragma once

#include <cstddef>
#include <string>
#include <utility>

#include "coordinator/tasks/rank_tasks.h"

namespace skyquilt::coordinator {

// In the setup that rank 0 sends.
inline const char* NameOf(TaskKind kind) {
  return kind == TaskKind::kMasks ? "masks" : "poses";
}

inline std::string TaskMessage(size_t number, const std::string& rest) {
  return std::to_string(number) + "\n" + rest;
}

inline std::pair<size_t, std::string> SplitTaskMessage(const std::string& bytes) {
  const size_t end = bytes.find('\n');
  return {std::stoull(bytes.substr(0, end)), bytes.substr(end + 1)};
}

}  // namespace skyquilt::coordinator
