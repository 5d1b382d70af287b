#!/usr/bin/env bash
# Builds the program with sanitizers and runs its tests with them. Takes an hour or two on two cores.
#   scripts/sanitize.sh [address|thread|all] [ctest options...]      default: all
# address: memory errors, leaks and undefined behaviour (clang); thread: data races (gcc). Reports caused by Open MPI itself are suppressed, see
# tests/support/lsan.supp and tests/support/tsan.supp.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
which=${1:-all}
(( $# > 0 )) && shift
case "$which" in
  address) presets=(asan) ;;
  thread) presets=(tsan) ;;
  all) presets=(asan tsan) ;;
  *) echo "usage: scripts/sanitize.sh [address|thread|all] [ctest options...]" >&2; exit 2 ;;
esac
scripts/setup.sh --fuzz
status=0
for preset in "${presets[@]}"; do
  compiler=()
  [[ "$preset" == asan ]] && compiler=(-DCMAKE_CXX_COMPILER=clang++ -DCMAKE_C_COMPILER=clang)
  cmake --preset "$preset" "${compiler[@]}" >/dev/null
  cmake --build "build/$preset"
  ctest --test-dir "build/$preset" --output-on-failure --timeout 3600 "$@" || status=1
done
exit "$status"
