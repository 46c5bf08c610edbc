#!/usr/bin/env bash
# check_install.sh: installs the libraries static and shared, each into a folder of its build (build/install-static,
# build/install-shared), and runs the programs of tests/consumer against both, found by CMake and by pkg-config.
set -euo pipefail
cd "$(dirname "$0")/.."

if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
for kind in static shared; do
  shared=OFF
  if [ "$kind" = shared ]; then shared=ON; fi
  build=build/install-$kind
  cmake --preset release -B "$build" -DBUILD_SHARED_LIBS=$shared -DOCCLOD_BUILD_TOOLS=OFF -DOCCLOD_BUILD_VIEWER=OFF >/dev/null
  cmake --build "$build" --target occlod_library occlod_gl_library
  ctest --test-dir "$build" -R '^(install_package|consumer.*)$' --output-on-failure --no-tests=error
done
