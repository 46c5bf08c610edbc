#!/usr/bin/env bash
# check_web.sh [FOLDER]: builds the npm package and the page (scripts/web.sh), and tests both against the native command line: the
# package in Node, TypeScript's compiler, the page in headless Chromium. Pictures of the page are left in FOLDER, out/web when
# not given. Needs Node with npm, a connection to its registry, and Chromium (CHROMIUM: where it is); says so and exits with
# 77 where one is missing. OCCLOD: a built program; builds it when not given. OCCLOD_MESHES: folders of real meshes.
set -euo pipefail
cd "$(dirname "$0")/.."

skip() { echo "SKIPPED: check_web.sh: $1" >&2; exit 77; }
command -v npm >/dev/null || skip "npm is missing"
CHROMIUM=${CHROMIUM:-$(command -v chromium || command -v chromium-browser || command -v google-chrome)} || skip "Chromium is missing"

scripts/web.sh
if [ -z "${OCCLOD:-}" ]; then
  scripts/build.sh demo
  OCCLOD=$PWD/build/demo/tools/occlod
fi
out=${1:-out/web}
mkdir -p "$out" build/web/tests
OCCLOD=$(realpath "$OCCLOD") OCCLOD_ROOT=$PWD OCCLOD_PAGE=$PWD/build/npm/page OCCLOD_PICTURES=$(realpath "$out")
OCCLOD_PACKAGE=$(echo "$PWD"/build/npm/occlod-[0-9]*.tgz)
OCCLOD_THREE=$(echo "$PWD"/build/npm/occlod-three-*.tgz)
export CHROMIUM OCCLOD OCCLOD_ROOT OCCLOD_PAGE OCCLOD_PICTURES OCCLOD_PACKAGE
cp tests/web/* build/web/tests
cd build/web/tests
npm install --silent --no-save --no-audit --no-fund "$OCCLOD_PACKAGE" "$OCCLOD_THREE" || skip "the packages of tests/web cannot be installed"
node --test package_test.js
node --test page_test.js
node --test ktx2_test.js
node --test hlod_test.js
node --test three_test.js
node --test tiles_test.js
