// Includes toml++ with its internal assertions turned into exceptions. In version 3.3 some malformed keys ("[|a") fail an assertion: the program
// would abort, or with NDEBUG have undefined behaviour. Private to core/config; include before any other header of toml++.
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
#pragma GCC diagnostic ignored "-Wterminate"  // in noexcept functions a failed assertion still ends the program
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
