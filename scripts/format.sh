#!/usr/bin/env bash
# Formats all C++ files in place. With --check it changes nothing and fails if a file is not formatted.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
case "${1:-}" in
  "") mode=(-i) ;;
  --check) mode=(--dry-run --Werror) ;;
  *) echo "usage: scripts/format.sh [--check]" >&2; exit 2 ;;
esac
find app bench buildings coordinator core evaluate masks merge odm partition prepare products python simulate surface tests tour viewer worker \( -name '*.h' -o -name '*.cpp' \) -print0 | sort -z | xargs -0 -n 32 clang-format "${mode[@]}"
