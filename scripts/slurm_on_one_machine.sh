#!/usr/bin/env bash
# Runs scripts/skyquilt.slurm on a real Slurm of two nodes, on this machine: a small survey is trained over both, one node is taken away, then the time
# limit comes. Slurm must queue the job again each time, and its result must have the bits of an undisturbed run. Takes about five minutes on two cores.
#   scripts/slurm_on_one_machine.sh [--steps 15000] [--keep FOLDER]
# --steps N       steps of each field; with few, the job is done before it can be disturbed
# --keep FOLDER   an empty folder for everything that is made, to read the logs of Slurm afterwards (default: a temporary one, removed at the end)
# Needs root (or sudo) and Debian's packages slurmctld, slurmd, slurm-client and munge; they need not be set up, and their services are not used. The
# nodes have network, processes, host names and /tmp of their own. All of it ends with this script, also when it is killed.
# SKYQUILT: the program (default: the release build, built if missing).
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
for program in slurmctld slurmd sbatch munged mungekey ip mpirun; do
  PATH=$PATH:/usr/sbin command -v "$program" >/dev/null || {
    echo "$program is not installed. Debian: apt-get install slurmctld slurmd slurm-client munge iproute2 openmpi-bin" >&2
    exit 3
  }
done
if [[ -z "${SKYQUILT:-}" ]]; then
  scripts/setup.sh
  cmake --preset release >/dev/null
  cmake --build --preset release --target skyquilt
  SKYQUILT=build/release/skyquilt
fi
as_root=()
(( EUID == 0 )) || as_root=(sudo)
exec "${as_root[@]}" unshare --mount --net --uts --ipc --pid --fork --kill-child --mount-proc \
  python3 tests/e2e/slurm_drill.py "$(realpath "$SKYQUILT")" "$@"
