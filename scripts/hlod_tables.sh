#!/usr/bin/env bash
# The tables of Charalambos 2006, of Charalambos and others 2007 and of Guthe, Balazs and Klein 2006 with our figures beside
# theirs, and what HLODs are asked to reach with verdicts (docs/benchmarks/hlod.md, culling.md): builds what it needs,
# builds the HLODs, draws, prints.
# hlod_tables.sh [--quick] [--reuse] [--only PART,PART,...] [--crack-frames N] [--devices NAME,NAME,...]
#   --quick    fewer frames, fronts and small scenes only: a few minutes; figures are rough
#   --reuse    keep HLODs and runs that are in out/hlod from before, and do only what is missing
#   --only     make these parts anew and keep the others: table4, cover (Guthe and others); first (Charalambos 2006), second,
#              sessions (the scenes of 2006), slow, llvmpipe (2007); sweep, geomorphs, equal_errors, cracks, fronts; splits (against refinement by splits)
#   --crack-frames  in how many frames of each path crack pixels are counted (8; --quick: 2); 600: in all
#   --devices  simulated devices of the tables of Charalambos (virtual:query-dear,virtual:modern)
# Everything that is measured goes to out/hlod/*.json and *.csv, the tables to out/hlod/tables.md.
# OCCLOD_MESHES: folders with real meshes, separated by ':'; without them scenes are made of libcgal-demo's.
set -euo pipefail
cd "$(dirname "$0")/.."

options=()
while [ $# -gt 0 ]; do
  case $1 in
    --quick | --reuse) options+=("$1"); shift ;;
    --devices | --only | --crack-frames)
      [ $# -gt 1 ] || { echo "hlod_tables.sh: $1 needs a value; see the head of $0" >&2; exit 2; }
      options+=("$1" "$2"); shift 2 ;;
    *) echo "hlod_tables.sh: unknown option $1; see the head of $0" >&2; exit 2 ;;
  esac
done
runs=(python3 -B scripts/hlod_runs.py --occlod build/bench/tools/occlod --compare build/bench/bench/papers/bench_hlod_compare --cover build/bench/bench/cover/bench_cover_probability --out out/hlod "${options[@]}")
"${runs[@]}" --check

scripts/setup.sh
scripts/build.sh bench
scripts/get_demo_meshes.sh || echo "hlod_tables: going on with the meshes that are there" >&2
"${runs[@]}"
python3 -B scripts/hlod_tables.py out/hlod | tee out/hlod/tables.md
