#!/usr/bin/env bash
# Runs clang-tidy with the checks of .clang-tidy on every compiled file. Needs a configured build with SKYQUILT_UNITY off (default: build/debug).
#   scripts/lint.sh [FILE...]             only these files
#   scripts/lint.sh --changed [BASE]      only files that differ from BASE, uncommitted and untracked ones too. BASE is any commit or branch;
#                                         default: where this branch left origin/main, or else main
#   SKYQUILT_BUILD=build/asan scripts/lint.sh
# clang-tidy reads a header through a file that includes it. For a changed header --changed takes the .cpp of the same name and its test, or where
# there is neither the first .cpp that includes it. Others that include it are not looked at: the whole run does that.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${SKYQUILT_BUILD:-build/debug}
folders=(app bench buildings coordinator core evaluate masks merge odm partition prepare products python simulate surface tests tour viewer worker)

# The changed .cpp files and those that stand for a changed header.
changed() {
  local file stem found
  { git diff --name-only --diff-filter=d "$1" -- "${folders[@]}"; git ls-files --others --exclude-standard -- "${folders[@]}"; } | while read -r file; do
    case "$file" in
      *.cpp) echo "$file" ;;
      *.h)
        stem=${file%.h}
        found=$(ls "$stem.cpp" "tests/${stem}_test.cpp" 2>/dev/null || true)
        [[ -n "$found" ]] || found=$(git grep --untracked -l "#include \"$file\"" -- '*.cpp' | head -n 1 || true)
        if [[ -n "$found" ]]; then echo "$found"; else echo "lint: nothing includes $file" >&2; fi ;;
    esac
  done | sort -u
}

if [[ "${1:-}" == --changed ]]; then
  base=${2:-$(git rev-parse --verify --quiet --abbrev-ref origin/main || echo main)}
  since=$(git merge-base "$base" HEAD) || { echo "lint: no common commit with '$base'. Usage: scripts/lint.sh --changed [BASE]" >&2; exit 2; }
  mapfile -t files < <(changed "$since")
  printf 'lint: %d files for what changed since %s (%s)\n' "${#files[@]}" "$base" "$(git rev-parse --short "$since")"
elif (( $# > 0 )); then
  files=("$@")
else
  mapfile -t files < <(find "${folders[@]}" -name '*.cpp' | sort)
fi
(( ${#files[@]} > 0 )) || exit 0
if [[ ! -f "$build/compile_commands.json" ]]; then
  cmake --preset "$(basename "$build")" >/dev/null
fi
printf '%s\0' "${files[@]}" | xargs -0 -n 1 -P "$(nproc)" clang-tidy -p "$build" --quiet --extra-arg=-Wno-unknown-warning-option
