// toml++ with its own checks left on. Version 3.3 takes some malformed keys ("[|a") for impossible; it then aborts, or with NDEBUG promises the
// compiler what is not so. Here a failed check of its own is an exception. Private to this room; include before anything else of toml++.
#pragma once

#include <stdexcept>

namespace skyquilt::config {

struct FailedTomlCheck : std::logic_error {
  using std::logic_error::logic_error;
};

}  // namespace skyquilt::config

#ifdef NDEBUG
#undef NDEBUG
#define SKYQUILT_NDEBUG_LATER
#endif
#define TOML_ASSERT(expr) ((expr) ? static_cast<void>(0) : throw ::skyquilt::config::FailedTomlCheck(#expr))
#ifdef __GNUC__
#pragma GCC diagnostic push
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wterminate"  // checks in functions that do not throw end the program, as they did
#endif
#endif
#include <toml++/toml.h>
#ifdef __GNUC__
#pragma GCC diagnostic pop
#endif
#ifdef SKYQUILT_NDEBUG_LATER
#define NDEBUG
#undef SKYQUILT_NDEBUG_LATER
#endif
