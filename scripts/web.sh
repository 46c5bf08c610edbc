#!/usr/bin/env bash
# web.sh [serve [PORT]]: compiles the library and the command line to WebAssembly and packs the npm package
# build/npm/occlod-VERSION.tgz, in build/web; `serve`: then serves the page of web/ on http://127.0.0.1:PORT (8080). Needs Node with npm;
# the compiler comes by scripts/emscripten.sh, the dependencies from Debian's source packages. Exit status 77 where they cannot be had.
set -euo pipefail
cd "$(dirname "$0")/.."

command -v npm >/dev/null || { echo "web: SKIPPED: npm is missing" >&2; exit 77; }
OCCLOD_EMSCRIPTEN=$(scripts/emscripten.sh)
export OCCLOD_EMSCRIPTEN
sources=$(scripts/debian_sources.sh cli11 fmtlib glm libstb libzstd nlohmann-json3 tinygltf xxhash)
highway=$(scripts/debian_sources.sh --suite trixie highway)/highway  # that of Debian 12 lacks vectors of WebAssembly
fetched=("-DFETCHCONTENT_SOURCE_DIR_HWY=$highway")
licences=build/web/npm/licences
mkdir -p "$licences"
cp "$highway/LICENSE" "$licences/highway"
for pair in CLI11=cli11 FMT=fmtlib GLM=glm STB=libstb ZSTD=libzstd NLOHMANN_JSON=nlohmann-json3 TINYGLTF=tinygltf XXHASH=xxhash; do
  folder=$sources/${pair#*=}
  fetched+=("-DFETCHCONTENT_SOURCE_DIR_${pair%=*}=$folder")
  cat "$folder"/LICENSE* "$folder"/copying.txt >"$licences/${pair#*=}" 2>/dev/null || true
done
scripts/build.sh web "${fetched[@]}"

package=build/web/npm
mkdir -p "$package/wasm" build/npm
cp -r packaging/npm/occlod/{bin,index.js,index.d.ts,package.json,README.md} LICENSE "$package"
mv "$package"/{library,occlod}.{js,wasm} "$package/wasm"
