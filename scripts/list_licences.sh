#!/usr/bin/env bash
# Lists the Debian packages whose libraries a program loads, with version and licence, for docs/licences.md.
#   scripts/list_licences.sh [PROGRAM]      default: build/release/skyquilt
# The licence is the one that the package's copyright file names for "Files: *". That may be wrong for a library in a package of many licences:
# where it says GPL, and where it says "read", the file itself decides.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."
ldd "${1:-build/release/skyquilt}" | awk '$3 ~ /^\// { print $3 }' | while read -r library; do
  file=$(realpath "$library")
  # Debian 12 owns some libraries under /lib, which is the same folder as /usr/lib.
  owner=$(dpkg-query --search "$file" 2>/dev/null || dpkg-query --search "${file#/usr}" 2>/dev/null || echo "unpackaged: $file")
  echo "${owner%%:*}"
done | sort -u | while read -r package; do
  text=/usr/share/doc/$package/copyright
  licence=$(awk 'BEGIN { RS = "" } /(^|\n)Files: *\*/ && match($0, /\nLicense: *[^\n]*/) { print substr($0, RSTART + 10, RLENGTH - 10); exit }' "$text" 2>/dev/null || true)
  version=$(dpkg-query --show --showformat='${Version}\n' "$package" 2>/dev/null | head -n 1 || true)
  printf '%-28s %-32s %s\n' "$package" "$version" "${licence:-read $text}"
done
