#!/usr/bin/env bash
# Sets up, builds and runs the benchmarks one after the other. Results as text and JSON go to out/bench/.
# OCCLOD_MESHES: folders with real meshes, separated by ':'; benchmarks leave out those that are missing and say so.
set -euo pipefail
cd "$(dirname "$0")/.."

out=out/bench

if [ -z "${OCCLOD_MESHES:-}" ] && [ -d ../shared/meshes ]; then
  OCCLOD_MESHES=$(cd ../shared/meshes && pwd)
  export OCCLOD_MESHES
fi

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

echo "Results: $PWD/$out"
