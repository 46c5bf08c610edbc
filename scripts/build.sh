#!/usr/bin/env bash
# build.sh PRESET [cmake -D options]: configures and builds build/PRESET, through ccache where it is installed.
set -euo pipefail
cd "$(dirname "$0")/.."

preset=$1
shift
if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache
  export CCACHE_SLOPPINESS=${CCACHE_SLOPPINESS:-pch_defines,time_macros}  # what precompiled headers need
fi
cmake --preset "$preset" "$@" >&2
cmake --build --preset "$preset" >&2
