#!/usr/bin/env bash
# HLODs refined by occlusion queries as one offline page, out/hlod/report.html: the tables and figures of the papers with ours
# beside them, what accuracy costs in time, what `auto` chose and why, and verdicts.
# hlod_report.sh [--small | --quick] [--out FOLDER] [--occlod FILE --compare FILE --cover FILE]
#   --small   of tiny stand-ins of the scenes (bench/scenes/small), to out/hlod_small: seconds, for tests
#   --quick   fewer frames and scenes, to out/hlod_quick
#   --occlod, --cover  built programs: occlod and bench_cover_probability; builds both when not given
# What scripts/hlod_tables.sh, or an earlier run, has left in the folder is reused; delete the folder to measure anew.
# OCCLOD_MESHES: folders with real meshes, separated by ':'.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)

out=
occlod=
compare=
cover=
effort=()
while [ $# -gt 0 ]; do
  case $1 in
    --small) effort=(--small --scenes "$root/bench/scenes/small"); out=${out:-$root/out/hlod_small}; shift ;;
    --quick) effort=(--quick); out=${out:-$root/out/hlod_quick}; shift ;;
    --out) out=${2:?hlod_report.sh: --out needs a folder}; shift 2 ;;
    --occlod) occlod=${2:?hlod_report.sh: --occlod needs a file}; shift 2 ;;
    --compare) compare=${2:?hlod_report.sh: --compare needs a file}; shift 2 ;;
    --cover) cover=${2:?hlod_report.sh: --cover needs a file}; shift 2 ;;
    *) echo "hlod_report.sh: unknown option $1; see the head of $0" >&2; exit 2 ;;
  esac
done
out=${out:-$root/out/hlod}

if [ -z "$occlod" ] || [ -z "$compare" ] || [ -z "$cover" ]; then
  "$root/scripts/setup.sh"
  "$root/scripts/build.sh" bench
  "$root/scripts/get_demo_meshes.sh" || echo "hlod_report: going on with the meshes that are there" >&2
  occlod=${occlod:-$root/build/bench/tools/occlod}
  compare=${compare:-$root/build/bench/bench/papers/bench_hlod_compare}
  cover=${cover:-$root/build/bench/bench/cover/bench_cover_probability}
fi
python3 -B "$root/scripts/hlod_runs.py" --occlod "$occlod" --compare "$compare" --cover "$cover" --out "$out" --reuse "${effort[@]}"
python3 -B "$root/scripts/hlod_page.py" "$out"
