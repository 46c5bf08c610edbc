#!/usr/bin/env bash
# What walking through view cells is asked to reach, measured in one run: builds what it needs, builds the cells of scenes,
# walks through them, prints one table a scene with targets, figures and verdicts (docs/benchmarks/view_cells.md).
# viewcells_tables.sh [--quick] [--reuse] [SCENE...]
#   --quick  the small scenes that stand for these in tests, smaller images: a minute; figures are rough
#   --reuse  keep cells that are in out/viewcells from before
#   SCENE    scenes of meshes/scenes (vlod_city vlod_city_one vlod_plant), or scene files of your own
# Everything that is measured goes to out/viewcells/*.json, the tables to out/viewcells/tables.md.
# OCCLOD_MESHES: folders with real meshes, separated by ':'.
set -euo pipefail
cd "$(dirname "$0")/.."

out=out/viewcells
folder=meshes/scenes
quick=()
reuse=0
scenes=()
for argument in "$@"; do
  case $argument in
    --quick) quick=(--quick); folder=bench/scenes/small ;;
    --reuse) reuse=1 ;;
    -*) echo "viewcells_tables.sh: unknown option $argument; see the head of $0" >&2; exit 2 ;;
    *) scenes+=("$argument") ;;
  esac
done
[ ${#scenes[@]} -gt 0 ] || scenes=(vlod_city vlod_city_one vlod_plant)

scripts/setup.sh >&2
scripts/build.sh bench >&2
mkdir -p "$out"
results=()
for scene in "${scenes[@]}"; do
  file=$folder/$scene.json
  case $scene in *.json) file=$scene ;; esac
  name=$(basename "$file" .json)${quick:+_quick}
  cells=$out/$name.vlod
  if [ "$reuse" = 0 ] || [ ! -f "$cells" ]; then
    build/bench/tools/occlod cells build "$file" -o "$cells" --image 1024x768,60,0.1 >&2
  fi
  build/bench/bench/viewcells/bench_viewcells "$cells" "$file" "${quick[@]}" > "$out/$name.json"
  results+=("$out/$name.json")
done
python3 -B scripts/viewcells_table.py "${results[@]}" | tee "$out/tables.md"
