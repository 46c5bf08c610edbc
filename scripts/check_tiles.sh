#!/usr/bin/env bash
# Tilesets of `occlod tiles` in other people's programs: every content by the glTF validator of Khronos, and a path in CesiumJS and in
# 3DTilesRendererJS in headless Chromium, whose triangles are counted beside those of `occlod hlod render` at the same error. Needs Node with npm, a
# connection to its registry, and Chromium (CHROMIUM: where it is); says so and exits with 77 where one is missing.
# check_tiles.sh [SCENE.json] [--paths NAME,...] [--frames N] [--error PX] [--size WxH] [--picture K] [--occlod FILE] [--out FOLDER]
#   SCENE.json  meshes/scenes/city.json when not given; its paths, `walk,fly_over`, at the first N of their keys; pictures of the K-th
#   --occlod    a built program; builds it when not given
# Pictures, tilesets and tiles.json are left in FOLDER, out/tiles when not given.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)

scene=$root/meshes/scenes/city.json
out=$root/out/tiles
occlod=
rest=()
while [ $# -gt 0 ]; do
  case $1 in
    --occlod) occlod=${2:?check_tiles.sh: --occlod needs a file}; shift 2 ;;
    --out) out=${2:?check_tiles.sh: --out needs a folder}; shift 2 ;;
    --paths | --frames | --error | --size | --picture) rest+=("$1" "${2:?check_tiles.sh: $1 needs a value}"); shift 2 ;;
    -*) echo "check_tiles.sh: unknown option $1; see the head of $0" >&2; exit 2 ;;
    *) scene=$1; shift ;;
  esac
done

skip() {
  echo "SKIPPED: check_tiles.sh: $1" >&2
  exit 77
}
command -v npm > /dev/null || skip "npm is missing"
[ -n "${CHROMIUM:-}" ] || command -v chromium chromium-browser google-chrome > /dev/null || skip "Chromium is missing"

if [ -z "$occlod" ]; then
  "$root/scripts/build.sh" release
  occlod=$root/build/release/tools/occlod
fi
mkdir -p "$out/npm"
cp "$root/tests/clients/package.json" "$out/npm"
(cd "$out/npm" && npm install --no-audit --no-fund --silent) || skip "the packages of tests/clients cannot be installed"
exec python3 "$root/scripts/tiles_clients.py" --occlod "$occlod" --modules "$out/npm/node_modules" --out "$out" "$scene" "${rest[@]}"
