// The message of the error that an action throws; empty when it throws none.
#pragma once

#include <string>

#include "core/base/errors.h"

namespace skyquilt {

template <typename Error, typename Action>
std::string ErrorOf(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

template <typename Action>
std::string InputErrorOf(const Action& action) {
  return ErrorOf<base::InputError>(action);
}

template <typename Action>
std::string UsageErrorOf(const Action& action) {
  return ErrorOf<base::UsageError>(action);
}

}  // namespace skyquilt
