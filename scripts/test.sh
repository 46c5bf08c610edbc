#!/usr/bin/env bash
# test.sh [--quick | --all]: sets up, builds with warnings as errors, and runs every test of what users are promised.
#   --quick  leaves out the tests that are labelled `slow`
#   --all    also builds the benchmarks and tests them, lints, and feeds each reader with mutated files for five seconds,
#            where Clang can
# What was skipped is told in the last lines. The very last one is "N passed, N failed", with ", N skipped" where there are
# such: single tests, and lint and fuzzing as one each where they failed or were skipped.
# OCCLOD_MESHES: folders with real meshes, separated by ':'; tests that miss one are skipped and say so.
set -euo pipefail
cd "$(dirname "$0")/.."

choice=${1:-}
preset=release
benchmarks=OFF
case $choice in
  "") ;;
  --quick) preset=quick ;;
  --all) benchmarks=ON ;;
  *) echo "test.sh: unknown option $choice; see the head of $0" >&2; exit 2 ;;
esac

scripts/setup.sh
scripts/build.sh release -U "OCCLOD_BUILD_*" -U "OCCLOD_WITH_*" -DOCCLOD_BUILD_TESTS=ON \
  -DOCCLOD_BUILD_BENCH=$benchmarks -DOCCLOD_WARNINGS_AS_ERRORS=ON -DOCCLOD_TEST_PCH=ON

results=build/release/Testing
rm -rf "$results/gtest" "$results/junit.xml"
status=0
ctest --preset "$preset" -j "$(nproc)" --output-junit Testing/junit.xml \
  --test-output-size-passed 4096 --test-output-truncation head || status=1

failed=0
skipped=()
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# part COMMAND...: one that exits with 77 could not check everything, and says so in its last line.
part() {
  local result=0
  "$@" | tee "$log" || result=$?
  case $result in
    0) ;;
    77) skipped+=("$(tail -n 1 "$log")") ;;
    *) failed=$((failed + 1)) ;;
  esac
}

case $choice in
  --quick) skipped+=("tests labelled slow: SKIPPED (scripts/test.sh runs them)") ;;
  --all)
    part scripts/lint.sh build/release
    part scripts/fuzz.sh 5
    ;;
esac

python3 -B scripts/count_tests.py build/release "$results/junit.xml" --failed "$failed" --skipped "${skipped[@]}" || status=1
[ "$status" -eq 0 ] && [ "$failed" -eq 0 ]
