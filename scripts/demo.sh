#!/usr/bin/env bash
# Runs everything on a simulated town: set-up, build, simulate, train, merge, maps, tour, report.
#   scripts/demo.sh [FOLDER]             default folder: out/demo in the repository
#   SKYQUILT_DEMO_BUDGET=10min scripts/demo.sh    training time (default 2min)
# If it was stopped, the same command resumes and repeats nothing.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
out=$(realpath -m "${1:-$root/out/demo}")
budget=${SKYQUILT_DEMO_BUDGET:-2min}
cd "$root"

times=()
step() {
  local name=$1 start=$SECONDS
  shift
  echo "== $name"
  "$@"
  times+=("$(printf '%-28s %5d s' "$name" $((SECONDS - start)))")
}

build() {
  cmake --preset release
  cmake --build --preset release --target skyquilt
}

scores() {
  python3 - "$out/report/metrics.json" <<'PYTHON'
import json
import sys

with open(sys.argv[1], encoding="utf-8") as file:
    metrics = json.load(file)


def line(label, key, unit, digits):
    value = metrics.get(key)
    print(f"{label:<28} " + ("not measured" if value is None else f"{value:.{digits}f}{unit}"))


line("PSNR, held-out views", "psnr", " dB", 2)
line("SSIM, held-out views", "ssim", "", 3)
line("FLIP, held-out views", "flip", "", 3)
line("median depth error", "depth_median_abs_m", " m", 3)
scored = metrics
surface = metrics.get("surface")
if surface:
    metrics = {"mesh": surface["psnr"], "agree": next((entry["f"] for entry in surface["f_scores"] if entry["tau"] == "2 GSD"), None)}
    line("PSNR of the textured mesh", "mesh", " dB", 2)
    line("F-score of the mesh, 2 GSD", "agree", "", 3)
buildings = scored.get("buildings")
if buildings:
    metrics = {"found": buildings["found"], "complete": buildings.get("building_completeness")}
    line("buildings found and measured", "found", "", 0)
    line("of the true ones in the area", "complete", "", 2)
PYTHON
}

skyquilt=build/release/skyquilt
step "set-up" scripts/setup.sh --run
step "build" build
step "simulate" "$skyquilt" simulate town -o "$out/simulated"
step "run ($budget of training)" "$skyquilt" run --place town -o "$out" --blocks 2x2 --time-budget "$budget" \
  --set tour.auto=3 --set tour.still_width=1280 --set tour.still_height=720 --set tour.panorama_width=2048

echo "== done"
printf '%s\n' "${times[@]}"
printf '%-28s %5d s\n' "all" "$SECONDS"
scores
echo "report: $out/report/index.html"
echo "mesh, cloud, tiles, terrain: $out/surface"
echo "buildings and their measures: $out/buildings/buildings.csv"
echo "a tour that plays in any browser: $out/tour/index.html"
echo "look at it in the browser: $skyquilt view $out"
