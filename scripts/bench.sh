#!/usr/bin/env bash
# Sets up, builds and runs the benchmarks one after the other. Results as text and JSON go to out/bench/.
# OCCLOD_MESHES: folders with real meshes, separated by ':'; benchmarks leave out those that are missing and say so.
set -euo pipefail
cd "$(dirname "$0")/.."

out=out/bench

scripts/setup.sh
scripts/build.sh bench
mkdir -p "$out"

echo "bench_build" >&2
build/bench/bench/bench_build --benchmark_repetitions=3 --benchmark_report_aggregates_only=true --benchmark_counters_tabular=true \
  --benchmark_out="$out/build.json" --benchmark_out_format=json | tee "$out/build.txt"

echo "bench_build_peers" >&2
build/bench/bench/bench_build_peers --repeat 5 --json "$out/build_peers.json" | tee "$out/build_peers.txt"

echo "bench_error_bound" >&2
build/bench/bench/bench_error_bound | tee "$out/error_bound.md"

echo "bench_wedges" >&2
build/bench/bench/bench_wedges --repeat 3 --csv "$out/wedges.csv" | tee "$out/wedges.md"

echo "bench_hlod_build" >&2
build/bench/bench/bench_hlod_build | tee "$out/hlod_build.md"

# Builds and keeps the planet of level 11, 33.5 million triangles: a minute, 8 GB of memory and 2 GB of disk.
echo "bench_refine" >&2
build/bench/bench/bench_refine --folder "$out/planets" | tee "$out/refine.md"

echo "bench_scratch" >&2
build/bench/bench/bench_scratch | tee "$out/scratch.md"

echo "bench_limit" >&2
build/bench/bench/bench_limit | tee "$out/limit.md"

echo "bench_locality" >&2
build/bench/bench/bench_locality | tee "$out/locality.md"

echo "bench_cells" >&2
build/bench/bench/bench_cells | tee "$out/cells.csv"

for name in order shrunk rays; do
  echo "bench_cell_$name" >&2
  "build/bench/bench/viewcells/bench_cell_$name" | tee "$out/cell_$name.csv"
done

echo "bench_cover_probability" >&2
build/bench/bench/cover/bench_cover_probability | tee "$out/cover_probability.md"

echo "bench_software_occlusion" >&2
build/bench/bench/bench_software_occlusion | tee "$out/software_occlusion.txt"

echo "bench_hlod_device" >&2
build/bench/bench/bench_hlod_device --benchmark_counters_tabular=true --benchmark_out="$out/hlod_device.json" \
  --benchmark_out_format=json | tee "$out/hlod_device.txt"

echo "bench_stability" >&2
build/bench/bench/report/bench_stability | tee "$out/stability.md"

echo "bench_frames" >&2
build/bench/bench/bench_frames | tee "$out/frames.md"

echo "bench_visibility" >&2
build/bench/bench/visibility/bench_visibility --out "$out/visibility" | tee "$out/visibility.md"
build/bench/bench/visibility/bench_visibility --wrongly-hidden --out "$out/visibility" | tee "$out/wrongly_hidden.md"

echo "bench_report" >&2
scripts/report.sh --bench build/bench/bench/report/bench_report --out "$out/report"

echo "bench_gl_occlusion" >&2
build/bench/bench/bench_gl_occlusion | tee "$out/gl_occlusion.txt" || echo "bench_gl_occlusion is left out" >&2

# llvmpipe without threads of its own and with two.
for threads in 0 2; do
  echo "bench_gl_device, LP_NUM_THREADS=$threads" >&2
  LP_NUM_THREADS=$threads build/bench/bench/bench_gl_device --benchmark_repetitions=7 --benchmark_report_aggregates_only=true \
    --benchmark_counters_tabular=true --benchmark_out="$out/gl_device_$threads.json" --benchmark_out_format=json |
    tee "$out/gl_device_$threads.txt" || echo "bench_gl_device is left out" >&2
done

# Builds the version that it compares with. Prints and writes the table of targets and verdicts.
echo "bench_targets" >&2
scripts/bench_targets.sh

echo "Results: $PWD/$out"
