#!/usr/bin/env bash
# clang-tidy with the checks of .clang-tidy over every compiled file. Needs a configured build (default: build/ci, as scripts/test.sh makes).
#   scripts/lint.sh [FILE...]             only these files
#   SKYQUILT_BUILD=build/debug scripts/lint.sh
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${SKYQUILT_BUILD:-build/ci}
if [[ ! -f "$build/compile_commands.json" ]]; then
  echo "lint: $build has no compile_commands.json; run 'cmake --preset ci' first" >&2
  exit 2
fi
if (( $# > 0 )); then
  printf '%s\0' "$@"
else
  find core partition worker coordinator tests -name '*.cpp' -print0 | sort -z
fi | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option
