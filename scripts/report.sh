#!/usr/bin/env bash
# What accuracy costs in time: sweeps the knobs of refinement over scenes and camera paths and makes one page of it, out/report/report.html, with
# report.json, points.csv and stability.json beside it.
# report.sh [--small] [--out FOLDER] [--bench FILE]
#   --small  three scenes, small pictures and budgets: seconds, for tests
#   --bench  a built bench_report, with bench_stability beside it; sets up and builds both when not given
# OCCLOD_MESHES: folders with real meshes, separated by ':'; scenes that miss one are skipped and say so.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)

out=$root/out/report
bench=
small=()
stability=()
while [ $# -gt 0 ]; do
  case $1 in
    --small) small=(--small); stability=(planet:5 --budget 1000 --repeat 3); shift ;;
    --out) out=${2:?report.sh: --out needs a folder}; shift 2 ;;
    --bench) bench=${2:?report.sh: --bench needs a file}; shift 2 ;;
    *) echo "report.sh: unknown option $1; see the head of $0" >&2; exit 2 ;;
  esac
done

if [ -z "$bench" ]; then
  "$root/scripts/setup.sh"
  "$root/scripts/build.sh" bench
  bench=$root/build/bench/bench/report/bench_report
fi

commit=$(git -C "$root" describe --always --dirty 2>/dev/null || true)
"$bench" "${small[@]}" --out "$out" --commit "$commit"
"$(dirname "$bench")/bench_stability" "${stability[@]}" --json "$out/stability.json" >/dev/null
python3 -B "$root/bench/report/page.py" "$out"
