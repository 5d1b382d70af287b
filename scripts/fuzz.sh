#!/usr/bin/env bash
# Searches for inputs that break the file readers: libFuzzer with address and undefined-behaviour sanitizers, and limits on memory and time per input.
#   scripts/fuzz.sh [SECONDS] [TARGET...]      default: 60 seconds for each of those below
# Findings are kept as build/fuzz/findings/TARGET-*. After a fix, copy the input to tests/fuzz/corpus/TARGET: the unit tests read all files there.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
seconds=${1:-60}
[[ "$seconds" =~ ^[1-9][0-9]*$ ]] || { echo "usage: scripts/fuzz.sh [SECONDS] [TARGET...]" >&2; exit 2; }
targets=("${@:2}")
(( ${#targets[@]} > 0 )) || targets=(colmap config blocks archive exif viewer tour transforms opensfm metashape opf poses_bounds positions text_table picture_header pixels
  gcp_list opensfm_control point_table metashape_markers)
scripts/setup.sh
cmake -S . -B build/fuzz -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ -DSKYQUILT_FUZZ=ON -DSKYQUILT_UNITY=ON -DSKYQUILT_PCH=ON \
  -DSKYQUILT_SANITIZE=address,undefined,fuzzer-no-link >/dev/null
cmake --build build/fuzz --target "${targets[@]/#/fuzz_}" "${targets[@]/#/libfuzz_}"
failed=0
for target in "${targets[@]}"; do
  corpus=build/fuzz/corpus/$target
  mkdir -p "$corpus" build/fuzz/findings
  ASAN_OPTIONS=detect_leaks=0 "build/fuzz/tests/fuzz/fuzz_$target" --seeds "$corpus"
  kept=()
  [[ -d "tests/fuzz/corpus/$target" ]] && kept=("tests/fuzz/corpus/$target")
  echo "== $target: $seconds s"
  "build/fuzz/tests/fuzz/libfuzz_$target" "$corpus" "${kept[@]}" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=3072 -max_len=65536 \
    -artifact_prefix="build/fuzz/findings/$target-" -print_final_stats=1 2>"build/fuzz/$target.log" || failed=1
  tail -n 8 "build/fuzz/$target.log"
done
exit "$failed"
