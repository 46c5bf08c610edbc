#!/usr/bin/env bash
# fuzz.sh SECONDS [READER...]: feeds each reader (ply obj mtl off stl gltf scene olod ohlod orec vlod) with mutated files for so long, what answers requests
# for tiles with requests (request), and the refiner with operations (refiner). ohlod_header, ohlod_nodes and ohlod_blobs are the reader ohlod with files that
# are mutated there only. All start from tests/fuzz/corpus and, where there are any, the files of their format in the folders that OCCLOD_MESHES names.
# What is found stays in build/fuzz/found.
# Needs clang++-14 with libFuzzer; without it, says so and exits with 77. OCCLOD_CLANG: another clang++, with options.
set -euo pipefail
cd "$(dirname "$0")/.."

seconds=$1
shift
readers=("$@")
[ ${#readers[@]} -gt 0 ] || readers=(ply obj mtl off stl gltf scene olod ohlod ohlod_header ohlod_nodes ohlod_blobs orec vlod request refiner)
clang=${OCCLOD_CLANG:-clang++-14}
largest=65536  # bytes; larger seeds are left out

probe=$(mktemp -d)
trap 'rm -rf "$probe"' EXIT
echo 'extern "C" int LLVMFuzzerTestOneInput(const unsigned char*, unsigned long) { return 0; }' >"$probe/probe.cpp"
# shellcheck disable=SC2086  # OCCLOD_CLANG may hold options
if ! $clang -fsanitize=fuzzer,address,undefined "$probe/probe.cpp" -o "$probe/probe" 2>/dev/null; then
  echo "fuzz: SKIPPED (no ${clang%% *} with libFuzzer: packages clang-14, libclang-rt-14-dev)"
  exit 77
fi

# One form of the vector code: under sanitizers the one without vectors takes minutes to compile.
vectors=()
[ "$(uname -m)" = x86_64 ] && vectors=("-DCMAKE_CXX_FLAGS=-march=x86-64-v2 -DHWY_COMPILE_ONLY_STATIC")
CXX=$clang scripts/build.sh fuzz "${vectors[@]}"
mkdir -p build/fuzz/found

# The files of a reader in the folders of OCCLOD_MESHES.
seeds() {
  local folder names=(-iname "*.$1")
  [ "$1" = gltf ] && names+=(-o -iname '*.glb')
  IFS=: read -ra folders <<<"${OCCLOD_MESHES:-}"
  for folder in "${folders[@]}"; do
    if [ -d "$folder" ]; then find "$folder" -type f -size -"${largest}c" \( "${names[@]}" \) -print0; fi
  done
}

for reader in "${readers[@]}"; do
  format=${reader%%_*}
  corpus=build/fuzz/corpus/$reader
  mkdir -p "$corpus" "$probe/$reader"
  cp tests/fuzz/corpus/"$format"/* "$probe/$reader"
  words=()
  [ -f tests/fuzz/"$format".dict ] && words=(-dict=tests/fuzz/"$format".dict)
  seeds "$format" | xargs -0 -r cp -t "$probe/$reader" --no-preserve=mode
  echo "fuzz: $reader for $seconds s" >&2
  "build/fuzz/tests/fuzz/fuzz_$reader" -max_total_time="$seconds" -max_len="$largest" -timeout=10 -rss_limit_mb=2048 \
    -artifact_prefix="build/fuzz/found/$reader-" -print_final_stats=1 "${words[@]}" "$corpus" "$probe/$reader" 2>"$probe/log" ||
    { tail -n 60 "$probe/log" >&2; echo "fuzz: $reader FAILED" >&2; exit 1; }
  grep -E 'DONE|number_of_executed_units|peak_rss' "$probe/log" >&2
done
echo "fuzz: nothing found"
