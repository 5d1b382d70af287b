#!/usr/bin/env bash
# Sets up, builds everything with warnings as errors, and runs all tests. Ends with the summary and exit status of ctest.
#   scripts/test.sh [ctest options]      for instance: scripts/test.sh -R core_geo
# SKYQUILT_TEST_JOBS: number of tests to run in parallel (default: two more than there are cores).
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
if (( EUID == 0 )); then
  export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
fi

scripts/setup.sh
cmake --preset ci
cmake --build --preset ci
echo "build finished after ${SECONDS} s"
exec ctest --preset ci --parallel "${SKYQUILT_TEST_JOBS:-$(( $(nproc) + 2 ))}" "$@"
