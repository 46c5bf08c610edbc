#!/usr/bin/env bash
# What refinement and building are asked to reach, measured in one run: builds this version and commit 582fcf1 of its
# history, runs both in turns, and prints one table of targets, figures and verdicts (docs/benchmarks/refinement.md).
# The table goes to out/bench/targets.md and targets.csv as well, all raw numbers to targets.json beside them.
# bench_targets.sh [--quick]
#   --quick  fewer rounds, frames, scenes and meshes: a few minutes; verdicts are rough
# Rows that compare with the commit are left out, and it says so, where the history does not have it.
# OCCLOD_MESHES: folders with real meshes, separated by ':'; what misses one is left out, and it says so.
set -euo pipefail
cd "$(dirname "$0")/.."

commit=582fcf1
source=build/reference/$commit
out=out/bench
options=(--build build/bench --out "$out/targets.json")
while [ $# -gt 0 ]; do
  case $1 in
    --quick) options+=(--quick); shift ;;
    *) echo "bench_targets.sh: unknown option $1; see the head of $0" >&2; exit 2 ;;
  esac
done

# Only what is run. The tests are configured for the pinned hashes alone; scripts/build.sh bench configures without them.
build_present() {
  cmake --preset bench -DOCCLOD_BUILD_TESTS=ON
  cmake --build --preset bench --target occlod_tool bench_frames bench_effects bench_build_peers test_hashes
}

has_reference() { git cat-file -e "$commit^{commit}" 2>/dev/null; }

# The command line of the commit.
build_reference() {
  if [ ! -d "$source" ]; then
    rm -rf "$source.part"
    mkdir -p "$source.part"
    git archive "$commit" | tar -x -C "$source.part"
    mv "$source.part" "$source"
  fi
  cmake --preset release -S "$source" -DOCCLOD_BUILD_TESTS=OFF -DOCCLOD_BUILD_VIEWER=OFF -DOCCLOD_BUILD_GL=OFF \
    -DOCCLOD_WITH_CGAL=OFF -DOCCLOD_WARNINGS_AS_ERRORS=OFF
  cmake --build "$source/build/release" --target occlod_tool
}

scripts/setup.sh
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
scripts/get_demo_meshes.sh || echo "bench_targets: going on with the meshes that are there" >&2
build_present >&2
if has_reference; then
  build_reference >&2
  options+=(--reference "$source/build/release/tools/occlod")
else
  echo "bench_targets: SKIPPED what compares with $commit: the history does not have it." \
    "In a shallow clone: git fetch --unshallow" >&2
fi

mkdir -p "$out"
python3 -B scripts/bench_targets.py "${options[@]}"
python3 -B scripts/targets_table.py "$out/targets.json" "$out/targets.csv" | tee "$out/targets.md"
