#!/usr/bin/env bash
# web.sh [serve [PORT]]: compiles the library and the command line to WebAssembly, in build/web, and packs the npm packages
# build/npm/occlod-VERSION.tgz and build/npm/occlod-three-VERSION.tgz; the page of web/ lies beside them, in build/npm/page,
# and `serve` serves it on http://127.0.0.1:PORT (8080). Needs Node with npm; the compiler comes by scripts/emscripten.sh, the
# dependencies from Debian's source packages; and zstd, which packs the command line. Exit status 77 where one cannot be had.
set -euo pipefail
cd "$(dirname "$0")/.."

for tool in npm zstd; do
  command -v "$tool" >/dev/null || { echo "web: SKIPPED: $tool is missing" >&2; exit 77; }
done
OCCLOD_EMSCRIPTEN=$(scripts/emscripten.sh)
export OCCLOD_EMSCRIPTEN
package=build/web/npm
rm -rf "$package/licences"
mkdir -p "$package/licences" build/npm/page/occlod

# Debian 12's Highway has no vectors of WebAssembly, and its zstd cannot leave out what level 3 does not need.
old=$(scripts/debian_sources.sh cli11 fmtlib glm libstb nlohmann-json3 tinygltf xxhash)
new=$(scripts/debian_sources.sh --suite trixie highway libzstd)
fetched=()
for pair in HWY=$new/highway ZSTD=$new/libzstd CLI11=$old/cli11 FMT=$old/fmtlib GLM=$old/glm STB=$old/libstb \
  NLOHMANN_JSON=$old/nlohmann-json3 TINYGLTF=$old/tinygltf XXHASH=$old/xxhash; do
  folder=${pair#*=}
  fetched+=("-DFETCHCONTENT_SOURCE_DIR_${pair%%=*}=$folder")
  find "$folder" -maxdepth 1 -type f \( -name 'LICENSE*' -o -name copying.txt \) -exec cat {} + >"$package/licences/$(basename "$folder")"
done
scripts/build.sh web "${fetched[@]}"

cp -r packaging/npm/occlod/{bin,calls.js,index.js,index.d.ts,hlod.js,hlod.d.ts,package.json,README.md} LICENSE "$package"
rm -f "$package"/wasm/occlod.*  # of an earlier build, perhaps by other names
cp build/web/command_line/occlod.js "$package/wasm"
zstd -qq --force --ultra -22 --long=27 --single-thread --patch-from="$package/wasm/library.wasm" build/web/command_line/occlod.wasm \
  -o "$package/wasm/occlod.wasm.patch"
npm pack --silent --pack-destination build/npm "./$package" >/dev/null
three=build/web/three
rm -rf "$three"
mkdir -p "$three"
cp packaging/npm/three/*.{js,ts,json,md} LICENSE "$three"
cp -r build/web/three_wasm "$three/wasm"
cp -r "$package/licences" "$three"
npm pack --silent --pack-destination build/npm "./$three" >/dev/null
cp web/* build/npm/page
cp -r "$package"/{calls.js,index.js,wasm,licences,LICENSE} build/npm/page/occlod
rm build/npm/page/occlod/wasm/{occlod,hlod}.*  # the command line; HLODs
if [ "${1:-}" = serve ]; then exec python3 -m http.server --bind 127.0.0.1 --directory build/npm/page "${2:-8080}"; fi
