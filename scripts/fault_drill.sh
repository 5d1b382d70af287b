#!/usr/bin/env bash
# Proves that nothing is lost: SIGKILLs of random ranks at random moments (inside checkpoint writes too), a full disk, a read-only folder and
# damaged checkpoints, over small trainings. Each must go on and end bit-identical to an undisturbed one. About ten minutes.
#   scripts/fault_drill.sh [--kills 200] [--truncations 20] [--flips 100] [--seed 1]
# SKYQUILT: the program (default: the release build, built if need be). The full disk is a small tmpfs: needs the right to mount, else skipped.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
if [[ -z "${SKYQUILT:-}" ]]; then
  scripts/setup.sh
  cmake --preset release >/dev/null
  cmake --build --preset release --target skyquilt
  SKYQUILT=build/release/skyquilt
fi
exec python3 tests/e2e/fault_drill.py "$(realpath "$SKYQUILT")" "$@"
