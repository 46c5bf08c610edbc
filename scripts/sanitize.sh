#!/usr/bin/env bash
# sanitize.sh address|thread: builds with GCC's sanitizers in build/sanitize or build/sanitize-thread and runs under them
# every test (address, with undefined behaviour) or those of what runs on several threads (thread): building hierarchies
# and HLODs, also streamed within a limit of memory, HLODs whose meshes a thread loads, topology, hierarchies shared by
# threads, refinement on two, building and walking through view cells, the viewer's workers. In the background of
# whatever else runs.
set -euo pipefail
cd "$(dirname "$0")/.."
renice -n 19 $$ >/dev/null

jobs=${OCCLOD_JOBS:-2}
case ${1:-} in
  address)
    CMAKE_BUILD_PARALLEL_LEVEL=$jobs scripts/build.sh sanitize
    status=0
    ctest --preset sanitize -j "$jobs" -E '^viewer_' || status=1
    # What the windows' drivers keep has no name once they are unloaded, by which it could be left out.
    ASAN_OPTIONS=detect_leaks=0 ctest --preset sanitize -R '^viewer_' || status=1
    exit $status
    ;;
  thread)
    if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
    cmake --preset sanitize-thread >&2
    cmake --build --preset sanitize-thread -j "$jobs" >&2
    export TSAN_OPTIONS="suppressions=$PWD/cmake/tsan_suppressions.txt"
    for test in core/test_core mesh/test_mesh raster/test_raster hierarchy/test_hierarchy hlod/test_hlod io/test_io traverse/test_traverse scene/test_scene refine/test_refine \
      viewcells/test_viewcells viewer/test_viewer; do
      filter='*'
      case $test in
        raster/*) filter='DrawBands.*' ;;
        hlod/*) filter='*Threads*:NodeStore.*:Stream*-*ALimitOfMemory*' ;;
        io/*) filter='*Ohlod*' ;;
        traverse/*) filter='Paged*' ;;
        scene/*) filter='Streamed*:LoadHlods.*' ;;
        refine/*) filter='SharedHierarchy.*:*Threads*' ;;
        viewcells/*) filter='CellWalkerTest.*:VlodFileTest.*Threads*:VlodFileTest.Cancel*:CellBuilder.CellsDoNot*' ;;
      esac
      program=build/sanitize-thread/tests/$test
      if [ -x "$program" ]; then "$program" --gtest_brief=1 --gtest_filter="$filter"; fi
    done
    ;;
  *)
    echo "usage: sanitize.sh address|thread" >&2
    exit 2
    ;;
esac
