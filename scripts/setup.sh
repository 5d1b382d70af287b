#!/usr/bin/env bash
# Installs the Debian 12 packages needed to build and run, except those already installed.
#   scripts/setup.sh         everything, including the Python module, tests and checks
#   scripts/setup.sh --run   only what the program needs
# SKYQUILT_SKIP_SETUP=1 skips it, for systems where the libraries are installed in another way.
set -euo pipefail

run_packages=(
  build-essential clang cmake ninja-build ccache pkg-config
  libopenmpi-dev openmpi-bin libeigen3-dev libopencv-dev colmap libgeographiclib-dev libhdf5-dev libhwy-dev
  libgdal-dev gdal-bin libexiv2-dev libheif-dev libraw-dev libtomlplusplus-dev libcli11-dev nlohmann-json3-dev libspdlog-dev libfmt-dev
  libembree-dev
  libboost-dev libceres-dev libproj-dev proj-data libpugixml-dev libsqlite3-dev zlib1g-dev ffmpeg python3
)
# The Python module; what its recipes draw with.
python_packages=(pybind11-dev python3-dev python3-numpy python3-matplotlib)
test_packages=(libgtest-dev librapidcheck-dev libbenchmark-dev git clang-format clang-tidy procps iproute2 dpkg-dev file assimp-utils chromium)
# Node from elsewhere brings its own npm, with which Debian's package conflicts.
command -v npm >/dev/null || run_packages+=(nodejs npm)

case "${1:-}" in
  --run) wanted=("${run_packages[@]}") ;;
  "") wanted=("${run_packages[@]}" "${python_packages[@]}" "${test_packages[@]}") ;;
  *) echo "usage: scripts/setup.sh [--run]" >&2; exit 2 ;;
esac

if [[ "${SKYQUILT_SKIP_SETUP:-0}" == 1 ]]; then
  echo "setup: skipped, because SKYQUILT_SKIP_SETUP=1"
  exit 0
fi

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  {
    echo "setup: this system has no apt-get. Install the contents of these Debian packages, then set SKYQUILT_SKIP_SETUP=1:"
    printf '  %s\n' "${wanted[@]}"
    echo "Needed versions: clang 14 or g++ 12 (-DCMAKE_C_COMPILER=gcc -DCMAKE_CXX_COMPILER=g++), CMake 3.25, COLMAP 3.8, Embree 3, OpenCV 4.6, GDAL 3.6, or newer ones that are compatible."
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
      echo "setup: sudo is not installed. As root run: apt-get install --no-install-recommends ${missing[*]}" >&2
      exit 2
    fi
    as_root=(sudo)
  fi
  echo "setup: installing ${missing[*]}"
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
fi
echo "setup: ${#wanted[@]} packages are installed, ${#missing[@]} of them new, ${SECONDS} s"
