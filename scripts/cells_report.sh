#!/usr/bin/env bash
# View cells as one offline page, out/cells_report/report.html: every table and figure of vLOD (Chhugani and others 2003) with ours beside it,
# what accuracy costs in seconds and bytes, rays and objects for comparison, and what larger clusters would take by a model.
# cells_report.sh [--small | --quick] [--out FOLDER] [--occlod FILE --bench FOLDER] [--cluster FILE] [SCENE...]
#   --small    tiny scenes, and less of everything, to out/cells_report_small: half a minute, for tests
#   --quick    the same scenes and more of everything, to out/cells_report_quick: some minutes; figures are rough
#   --occlod, --bench  built programs: occlod, and the folder of bench_viewcells and bench_cell_*; builds them when not given
#   --cluster  a table of bench/cells_cluster.py for the model; that of the results in the repository when not given
#   SCENE      scenes of meshes/scenes (vlod_city_one; a day's work), or scene files of your own
# What an earlier run has left in the folder is reused; delete the folder to measure anew.
# OCCLOD_MESHES: folders with real meshes, separated by ':'.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)

out=
occlod=
bench=
effort=()
rest=()
while [ $# -gt 0 ]; do
  case $1 in
    --small) effort=(--small); out=${out:-$root/out/cells_report_small}; shift ;;
    --quick) effort=(--quick); out=${out:-$root/out/cells_report_quick}; shift ;;
    --out) out=${2:?cells_report.sh: --out needs a folder}; shift 2 ;;
    --occlod) occlod=${2:?cells_report.sh: --occlod needs a file}; shift 2 ;;
    --bench) bench=${2:?cells_report.sh: --bench needs a folder}; shift 2 ;;
    --cluster) rest+=(--cluster "${2:?cells_report.sh: --cluster needs a file}"); shift 2 ;;
    -*) echo "cells_report.sh: unknown option $1; see the head of $0" >&2; exit 2 ;;
    *) rest+=("$1"); shift ;;
  esac
done
out=${out:-$root/out/cells_report}
python3 -B "$root/scripts/cells_runs.py" --check --out "$out" "${effort[@]}" "${rest[@]}"

if [ -z "$occlod" ] || [ -z "$bench" ]; then
  "$root/scripts/setup.sh" >&2
  "$root/scripts/build.sh" bench >&2
  occlod=${occlod:-$root/build/bench/tools/occlod}
  bench=${bench:-$root/build/bench/bench/viewcells}
fi
python3 -B "$root/scripts/cells_runs.py" --occlod "$occlod" --bench "$bench" --out "$out" "${effort[@]}" "${rest[@]}"
python3 -B "$root/scripts/cells_page.py" "$out"
