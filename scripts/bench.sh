#!/usr/bin/env bash
# Sets up, builds and makes the figures of the pages of docs/benchmarks anew, page by page. Results as text, CSV and JSON go to
# out/bench/PAGE.
# bench.sh [PAGE...]
#   PAGE  building, simplify, accuracy, refinement, occlusion, hlod, culling, view_cells, devices; all of them when none is named.
#         What needs a GPU or many cores is measured by check_gpu.sh, robustness by test.sh, sanitize.sh and fuzz.sh.
# OCCLOD_MESHES: folders with real meshes, separated by ':'; benchmarks leave out those that are missing and say so.
set -euo pipefail
cd "$(dirname "$0")/.."

pages=(building simplify accuracy refinement occlusion hlod culling view_cells devices)
programs=build/bench/bench

# run PROGRAM RESULT [OPTION...]: prints what it measures, and keeps it as out/bench/PAGE/RESULT.
run() {
  local program=$1 result=$2
  shift 2
  echo "$(basename "$program")" >&2
  "$programs/$program" "$@" | tee "$out/$result"
}

# Google Benchmark's programs: medians of several repetitions, as text and JSON.
run_repeated() {
  run "$1" "$1$2.txt" --benchmark_repetitions="$3" --benchmark_report_aggregates_only=true --benchmark_counters_tabular=true \
    --benchmark_out="$out/$1$2.json" --benchmark_out_format=json
}

building() {
  run_repeated bench_build "" 3
  run bench_build_peers build_peers.txt --repeat 5 --json "$out/build_peers.json"
  run bench_wedges wedges.md --percents 25 10 5 2.5 1 --csv "$out/wedges.csv"
  run bench_hlod_build hlod_build.md --only-time --threads 1 --repeat 3
  run bench_frames frames_vdpm.md --tables vdpm
}

# The packages of bench/peers/requirements.txt and our own, in a virtual environment; meshoptimizer from a crate that holds its sources.
simplify() {
  local venv=$out/venv crate=$out/crate library=()
  python3 -m venv "$venv"
  "$venv/bin/pip" install --quiet --disable-pip-version-check -r bench/peers/requirements.txt .
  if command -v cargo >/dev/null; then
    mkdir -p "$crate"
    touch "$crate/lib.rs"
    printf '%s\n' '[package]' 'name = "peers"' 'version = "0.0.0"' '[lib]' 'path = "lib.rs"' '[dependencies]' 'meshopt = "=0.7.0"' \
      >"$crate/Cargo.toml"
    (cd "$crate" && cargo vendor --quiet >/dev/null)
    library=(--meshoptimizer "$out/libmeshoptimizer.so")
    c++ -O3 -DNDEBUG -shared -fPIC "$crate"/vendor/meshopt/vendor/src/{allocator,simplifier}.cpp -o "${library[1]}"
  else
    echo "cargo is missing: meshoptimizer is left out" >&2
  fi
  "$venv/bin/python" -B bench/simplify_peers.py --occlod build/bench/tools/occlod --cgal $programs/bench_simplify_cgal "${library[@]}" \
    --csv "$out/simplify_peers.csv" | tee "$out/simplify_peers.md"
}

accuracy() {
  run bench_error_bound error_bound.md
  scripts/report.sh --bench $programs/report/bench_report --out "$out/report"
}

# docs/images has the bird's-eye pictures of armadillo_group and planet_near that bench_visibility leaves in out/bench/refinement/paper.
# bench_refine builds and keeps the planet of level 11, 33.5 million triangles: a minute, 8 GB of memory and 2 GB of disk.
# bench_targets.sh builds the version that it compares with.
refinement() {
  scripts/demo.sh
  run visibility/bench_visibility paper.md --paper --out "$out/paper"
  run bench_refine refine.md --folder "$out/planets"
  run bench_scratch scratch.md
  run bench_limit limit.md
  run bench_locality locality.md
  run bench_frames frames.md --frames 60 --repeat 3
  run visibility/bench_effects effects.md --frames 1 --search 1 --repeat 5
  scripts/hlod_tables.sh --only splits
  scripts/bench_targets.sh
}

occlusion() {
  run visibility/bench_visibility visibility.md --out "$out/visibility"
  run visibility/bench_visibility wrongly_hidden.md --wrongly-hidden --out "$out/visibility"
  run bench_software_occlusion software_occlusion.txt
  run bench_gl_occlusion gl_occlusion.txt || echo "bench_gl_occlusion is left out" >&2
}

hlod() {
  scripts/hlod_report.sh
}

culling() {
  scripts/hlod_tables.sh --only table4,cover
}

view_cells() {
  scripts/viewcells_tables.sh
  run bench_cells cells.csv
  for name in order shrunk rays; do run viewcells/bench_cell_$name cell_$name.csv; done
  scripts/cells_report.sh
}

# llvmpipe without threads of its own and with two.
devices() {
  run_repeated bench_hlod_device "" 3
  for threads in 0 2; do
    LP_NUM_THREADS=$threads run_repeated bench_gl_device _$threads 7 || echo "bench_gl_device is left out" >&2
  done
}

[ $# -gt 0 ] || set -- "${pages[@]}"
for page in "$@"; do
  if [[ " ${pages[*]} " != *" $page "* ]]; then
    echo "bench.sh: no page $page; there are ${pages[*]}" >&2
    exit 2
  fi
done

scripts/setup.sh
scripts/build.sh bench
for page in "$@"; do
  out=out/bench/$page
  mkdir -p "$out"
  $page
done
echo "Results: $PWD/out/bench"
