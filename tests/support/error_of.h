// Errors that an action throws.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "core/base/cancel.h"
#include "core/base/errors.h"

namespace skyquilt {

// The message; empty when it throws none of this kind.
template <typename Error, typename Action>
std::string ErrorOf(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// The error itself, nothing when it throws none.
template <typename Error, typename Action>
std::optional<Error> Caught(const Action& action) {
  try {
    action();
  } catch (const Error& error) {
    return error;
  }
  return {};
}

template <typename Action>
std::string InputErrorOf(const Action& action) {
  return ErrorOf<base::InputError>(action);
}

template <typename Action>
std::string UsageErrorOf(const Action& action) {
  return ErrorOf<base::UsageError>(action);
}

template <typename Action>
void ExpectStopsWhenAsked(const Action& action) {
  base::RequestCancel();
  EXPECT_THROW(action(), base::Interrupted);
  base::ClearCancel();
}

}  // namespace skyquilt
