#!/usr/bin/env bash
# Runs clang-tidy with the checks of .clang-tidy on every compiled file. Needs a configured build with SKYQUILT_UNITY off (default: build/debug).
#   scripts/lint.sh [FILE...]             only these files
#   SKYQUILT_BUILD=build/asan scripts/lint.sh
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${SKYQUILT_BUILD:-build/debug}
if [[ ! -f "$build/compile_commands.json" ]]; then
  cmake --preset "$(basename "$build")" >/dev/null
fi
if (( $# > 0 )); then
  printf '%s\0' "$@"
else
  find app bench coordinator core evaluate merge partition prepare products simulate tests worker -name '*.cpp' -print0 | sort -z
fi | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option
