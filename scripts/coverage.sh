#!/usr/bin/env bash
# coverage.sh: builds with line counts in build/coverage, runs the library's own tests, and prints for each file of lib/
# the share of its lines that ran and which did not (needs gcovr). In the background of whatever else the machine does.
# OCCLOD_MESHES as for test.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
renice -n 19 $$ >/dev/null

if ! command -v gcovr >/dev/null; then
  echo "coverage: gcovr is not here; install it (Debian, Ubuntu: gcovr)" >&2
  exit 1
fi
# What the command line and the viewer reach on their way says little. ccache would mix up where objects keep their counts.
CMAKE_BUILD_PARALLEL_LEVEL=${OCCLOD_JOBS:-2} CCACHE_DISABLE=1 scripts/build.sh coverage \
  -DOCCLOD_BUILD_TOOLS=OFF -DOCCLOD_BUILD_VIEWER=OFF -DOCCLOD_WITH_CGAL=OFF
find build/coverage -name '*.gcda' -delete
status=0
find build/coverage/tests -type f -executable -name 'test_*' -print0 | sort -z |
  xargs -0 -P "${OCCLOD_JOBS:-2}" -I {} env {} --gtest_brief=1 >&2 || status=1
gcovr --root . --filter lib/ --sort-uncovered --print-summary build/coverage
exit $status
