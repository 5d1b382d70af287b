#!/usr/bin/env bash
# Builds the tests with clang's sanitizers and runs those of units, ranks and readers. An hour and more each on two cores.
#   scripts/sanitize.sh [address|thread|all] [ctest options...]      default: all
# address: memory errors, leaks and undefined behaviour; thread: data races. Reports caused by Open MPI itself are suppressed, see
# tests/support/lsan.supp and tests/support/tsan.supp. With ctest options of your own, such as -R e2e_resume, exactly those tests run.
# If it was stopped, the same command goes on with the tests that have not passed yet; after a change of the code it begins anew.
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
selection=("$@")
(( ${#selection[@]} > 0 )) || selection=(-E '^(e2e|web)_')
scripts/setup.sh
status=0
for preset in "${presets[@]}"; do
  cmake --preset "$preset" >/dev/null
  cmake --build "build/$preset"
  passed=build/$preset/passed_tests.txt
  # Programs built after the list was begun may behave differently.
  if [[ -f $passed ]] && [[ -n $(find "build/$preset" -newer "$passed.begun" -type f -perm -u+x -not -path '*/Testing/*' -not -path '*/CMakeFiles/*' -print -quit) ]]; then
    rm -f "$passed"
  fi
  [[ -f $passed ]] || { touch "$passed" "$passed.begun"; }
  mapfile -t tests < <(ctest --test-dir "build/$preset" -N "${selection[@]}" | sed -n 's/^ *Test *#[0-9]*: //p')
  left=()
  for test in "${tests[@]}"; do
    grep -Fqx "$test" "$passed" || left+=("$test")
  done
  failed=()
  if (( ${#left[@]} > 0 )); then
    # The list grows while ctest prints, so that a stop loses the running tests only.
    ctest --test-dir "build/$preset" --output-on-failure --timeout 3600 --parallel "${SKYQUILT_TEST_JOBS:-$(nproc)}" \
      -R "^($(IFS='|'; echo "${left[*]}"))\$" 2>&1 | tee "build/$preset/tests.log" |
      sed -nu 's/^ *[0-9]*\/[0-9]* *Test *#[0-9]*: *\([^ ]*\) \.* *Passed.*/\1/p' |
      while read -r name; do
        echo "$name" >>"$passed"
        echo "$preset: $(wc -l <"$passed") of ${#tests[@]} passed: $name"
      done || true
    for test in "${left[@]}"; do
      grep -Fqx "$test" "$passed" || failed+=("$test")
    done
  fi
  echo "$preset: ${#tests[@]} tests, ${#failed[@]} failed: ${failed[*]}$( (( ${#failed[@]} == 0 )) || echo "; see build/$preset/tests.log")"
  (( ${#failed[@]} == 0 )) || status=1
done
exit "$status"
