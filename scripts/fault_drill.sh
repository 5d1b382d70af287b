#!/usr/bin/env bash
# Tests that no work is lost: small trainings are disturbed by SIGKILLs of random ranks at random moments (also during checkpoint writes), a full disk,
# a read-only folder and damaged checkpoints. Each must resume and end bit-identical to an undisturbed training. Takes about ten minutes.
#   scripts/fault_drill.sh [--kills 200] [--truncations 20] [--flips 100] [--seed 1]
# SKYQUILT: the program (default: the release build, built if missing). The full disk is a small tmpfs; this part is skipped without the right to mount.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
if [[ -z "${SKYQUILT:-}" ]]; then
  scripts/setup.sh
  cmake --preset release >/dev/null
  cmake --build --preset release --target skyquilt
  SKYQUILT=build/release/skyquilt
fi
exec python3 tests/e2e/fault_drill.py "$(realpath "$SKYQUILT")" "$@"
