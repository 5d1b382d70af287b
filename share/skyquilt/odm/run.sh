#!/bin/bash
# Starts 'skyquilt odm' with OpenDroneMap's options. The program is SKYQUILT if that is set, else the one of this installation, else the one on the
# PATH. exec: signals that are sent to this process reach the program.
here="$(cd "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")" && pwd)"
program="${SKYQUILT:-}"
if [ -z "$program" ] && [ -x "$here/../../../bin/skyquilt" ]; then
  program="$here/../../../bin/skyquilt"
fi
if [ -z "$program" ]; then
  program="$(command -v skyquilt)"
fi
if [ -z "$program" ] || [ ! -x "$program" ]; then
  echo "[ERROR]   The program skyquilt was not found${program:+ at $program}. Install its package, put it on the PATH, or set SKYQUILT to its path." >&2
  exit 3
fi
exec "$program" odm "$@"
