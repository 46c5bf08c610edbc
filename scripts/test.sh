#!/usr/bin/env bash
# Sets up, builds with warnings as errors, runs every test, then lints; with CI=true also fuzzes every reader for a few
# seconds, where Clang can. The last line is "N passed, N failed", where lint and fuzzing count as one each when they fail.
# OCCLOD_MESHES: folders with real meshes, separated by ':'; tests that miss one are skipped and say so.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ -z "${OCCLOD_MESHES:-}" ] && [ -d ../shared/meshes ]; then
  OCCLOD_MESHES=$(cd ../shared/meshes && pwd)
  export OCCLOD_MESHES
fi

scripts/setup.sh
scripts/build.sh release -DOCCLOD_BUILD_TESTS=ON -DOCCLOD_WARNINGS_AS_ERRORS=ON

log=$(mktemp)
trap 'rm -f "$log"' EXIT
tests_status=0
ctest --preset release -j "$(nproc)" 2>&1 | tee "$log" || tests_status=$?

lint_status=0
scripts/lint.sh build/release || lint_status=$?
if [ "$lint_status" -eq 0 ]; then echo "lint: clean"; else echo "lint: failed"; fi

fuzz_status=0
if [ "${CI:-}" = true ]; then scripts/fuzz.sh 5 || fuzz_status=$?; fi

# ctest: "98% tests passed, 2 tests failed out of 110"
python3 - "$log" "$lint_status" "$fuzz_status" <<'PY'
import re, sys
found = re.search(r"(\d+) tests? failed out of (\d+)", open(sys.argv[1], errors="replace").read())
failed, total = map(int, found.groups()) if found else (1, 1)
others_failed = sum(status != "0" for status in sys.argv[2:])
print(f"{total - failed} passed, {failed + others_failed} failed")
PY
[ "$tests_status" -eq 0 ] && [ "$lint_status" -eq 0 ] && [ "$fuzz_status" -eq 0 ]
