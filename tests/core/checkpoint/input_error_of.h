// The message of the base::InputError an action throws; empty when it throws none.
#pragma once

#include <functional>
#include <string>

#include "core/base/errors.h"

namespace skyquilt::checkpoint {

inline std::string InputErrorOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const base::InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace skyquilt::checkpoint
