#!/usr/bin/env bash
# check.sh: what differs from the main branch (scripts/changed.sh) is formatted, builds with everything that uses it,
# passes the unit tests of the folders that changed, and is clean of what lint.sh finds. For the time between an edit and
# a commit: less than a minute after an edit in one folder of lib/. scripts/test.sh checks everything.
# Configures build/release as test.sh does when it is not there.
set -euo pipefail
cd "$(dirname "$0")/.."

mapfile -t changed < <(scripts/changed.sh)
if [ ${#changed[@]} -eq 0 ]; then echo "check: nothing differs from the main branch"; exit 0; fi

# Folders of tests/ that have the tests of a changed file: those of its own name; core tests what has no folder.
test_folders() {
  printf '%s\n' "${changed[@]}" | sed -nE \
    -e 's#^lib/include/.*#core\nmesh\nhierarchy\nrefine\nhlod\nviewcells\nscene#p;t' \
    -e 's#^lib/base/.*#core#p;t' \
    -e 's#^lib/mesh/.*#mesh\nio#p;t' \
    -e 's#^lib/raster/.*#raster\nocclusion#p;t' \
    -e 's#^lib/splits/.*#hierarchy#p;t' \
    -e 's#^lib/refine/.*#cut\npriority\nqueries\nrefine\neffects#p;t' \
    -e 's#^lib/hlod/.*#hlod\ndevice\ntraverse\ntiles#p;t' \
    -e 's#^lib/cells/.*#viewcells#p;t' \
    -e 's#^lib/scene/.*#scene\npicture#p;t' \
    -e 's#^lib/gl/.*#gl#p;t' \
    -e 's#^tests/(oracle|support)/.*##;t' \
    -e 's#^tests/([a-z_]+)/.*#\1#p;t' \
    -e 's#^tools/repair/.*#repair#p;t' \
    -e 's#^(tools|viewer|bench|docs|scripts|examples)/.*#\1#p;t' \
    -e 's#^[^/]*\.md$#docs#p' | LC_ALL=C sort -u
}

scripts/build.sh release -U "OCCLOD_BUILD_*" -U "OCCLOD_WITH_*" -DOCCLOD_BUILD_TESTS=ON -DOCCLOD_WARNINGS_AS_ERRORS=ON -DOCCLOD_TEST_PCH=ON >&2

folders=$(test_folders | paste -sd '|')
left_out="tests of other folders"
if [ -n "$folders" ]; then
  ctest --preset release -j "$(nproc)" -L '^unit$' -L "^($folders)\$" --no-tests=ignore --output-on-failure
  left_out="all but the unit tests of $(echo "$folders" | sed 's/|/, /g')"
fi

status=0
scripts/lint.sh --changed build/release || status=$?
[ "$status" -eq 0 ] || [ "$status" -eq 77 ] || exit 1
echo "check: passed; left out $left_out: scripts/test.sh"
