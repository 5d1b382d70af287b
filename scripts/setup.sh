#!/usr/bin/env bash
# Installs what building and running needs on Debian 12, and nothing that is there already.
#   scripts/setup.sh         everything, tests and checks included
#   scripts/setup.sh --run   only what the program itself needs
#   scripts/setup.sh --fuzz  everything and clang, for scripts/fuzz.sh
# SKYQUILT_SKIP_SETUP=1 skips it, for systems where the libraries come from elsewhere.
set -euo pipefail

run_packages=(
  build-essential cmake ninja-build ccache pkg-config
  libopenmpi-dev openmpi-bin libeigen3-dev libopencv-dev colmap libgeographiclib-dev libhdf5-dev libhwy-dev
  libgdal-dev gdal-bin libexiv2-dev libtomlplusplus-dev libcli11-dev nlohmann-json3-dev libspdlog-dev libembree-dev
  ffmpeg python3
)
test_packages=(libgtest-dev librapidcheck-dev libbenchmark-dev git clang-format clang-tidy procps iproute2 dpkg-dev file)

case "${1:-}" in
  --run) wanted=("${run_packages[@]}") ;;
  "") wanted=("${run_packages[@]}" "${test_packages[@]}") ;;
  --fuzz) wanted=("${run_packages[@]}" "${test_packages[@]}" clang) ;;
  *) echo "usage: scripts/setup.sh [--run|--fuzz]" >&2; exit 2 ;;
esac

if [[ "${SKYQUILT_SKIP_SETUP:-0}" == 1 ]]; then
  echo "setup: skipped, because SKYQUILT_SKIP_SETUP=1"
  exit 0
fi

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  {
    echo "setup: this system has no apt-get. Install what these Debian packages hold, then set SKYQUILT_SKIP_SETUP=1:"
    printf '  %s\n' "${wanted[@]}"
    echo "Needed versions: g++ 12, CMake 3.25, COLMAP 3.8, Embree 3, OpenCV 4.6, GDAL 3.6, or newer ones that are compatible."
  } >&2
  exit 2
fi

missing=()
for package in "${wanted[@]}"; do
  state=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ "$state" == installed ]] || missing+=("$package")
done

if (( ${#missing[@]} > 0 )); then
  as_root=()
  if (( EUID != 0 )); then
    if ! command -v sudo >/dev/null; then
      echo "setup: no sudo here. As root run: apt-get install --no-install-recommends ${missing[*]}" >&2
      exit 2
    fi
    as_root=(sudo)
  fi
  echo "setup: installing ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
fi
echo "setup: ${#wanted[@]} packages are there, ${#missing[@]} of them new, ${SECONDS} s"
