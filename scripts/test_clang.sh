#!/usr/bin/env bash
# test_clang.sh: builds in build/clang with Clang (OCCLOD_CLANG, or clang++-14), warnings being errors and without precompiled
# headers, which hide missing includes; then runs the unit tests, of which `hashes` compares results with those of every other compiler.
set -euo pipefail
cd "$(dirname "$0")/.."

CXX=${OCCLOD_CLANG:-clang++-14} scripts/build.sh clang
ctest --preset clang -L '^unit$' -j "$(nproc)"
