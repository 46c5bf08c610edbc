#!/usr/bin/env bash
# check_compilers.sh [TARGET ...]: the library and its tests, without GL, compiled by clang with GCC's standard library and
# with libc++, without optimisation, and the tests run. TARGETs of the build, test programs for example, in place of all.
# Works in build/compilers. The names of the compilers: CLANG (clang++-14) and CLANG_LIBCXX (clang++-19: libc++ older than 16
# lacks parts of C++20). Says SKIPPED, with exit status 77, for what is not installed.
set -euo pipefail
cd "$(dirname "$0")/.."

root=$PWD
status=0
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
skip() { echo "check_compilers: SKIPPED $1: $2" >&2; status=77; }

# check NAME COMPILER FLAGS TARGET ...: whatever CMAKE_PREFIX_PATH holds comes before what the system has.
check() {
  local name=$1 compiler=$2 flags=$3 build=$root/build/compilers/$1
  shift 3
  echo "== $name: $compiler $flags"
  cmake -G Ninja -S . -B "$build" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER="$compiler" "-DCMAKE_CXX_FLAGS=$flags" \
    -DOCCLOD_WITH_CGAL=OFF -DOCCLOD_WITH_OPENMESH=OFF -DOCCLOD_BUILD_GL=OFF -DOCCLOD_BUILD_TOOLS=OFF \
    -DOCCLOD_BUILD_VIEWER=OFF -DOCCLOD_WARNINGS_AS_ERRORS=OFF >/dev/null
  cmake --build "$build" --target "${@:-all}"
  local program
  for program in "$build"/tests/*/test_*; do
    if [ ! -x "$program" ] || [ -d "$program" ]; then continue; fi
    if [ $# -gt 0 ] && [[ " $* " != *" ${program##*/} "* ]]; then continue; fi
    echo "-- ${program##*/}"
    (cd "$build" && "$program" --gtest_brief=1)
  done
}

# What is linked and speaks C++ is compiled with libc++ too, from the sources of Debian's packages.
install_for_libcxx() {
  local name=$1 source=$2 prefix=$root/build/compilers/libcxx-packages
  shift 2
  [ -e "$prefix/$name.installed" ] && return
  cmake -G Ninja -S "$source" -B "$prefix/build/$name" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$libcxx_compiler" \
    "-DCMAKE_CXX_FLAGS=-stdlib=libc++" "-DCMAKE_INSTALL_PREFIX=$prefix" -DCMAKE_POSITION_INDEPENDENT_CODE=ON "$@" >/dev/null
  cmake --build "$prefix/build/$name" --target install >/dev/null
  touch "$prefix/$name.installed"
}

compiler=${CLANG:-clang++-14}
if command -v "$compiler" >/dev/null; then
  check clang "$compiler" "" "$@"
else
  skip "clang with GCC's library" "no $compiler here"
fi

libcxx_compiler=${CLANG_LIBCXX:-clang++-19}
if ! echo '#include <version>' | "$libcxx_compiler" -stdlib=libc++ -std=c++20 -x c++ -fsyntax-only - 2>/dev/null; then
  skip "libc++" "no $libcxx_compiler with libc++ here (clang-19, libc++-19-dev, libc++abi-19-dev)"
elif ! sources=$(scripts/debian_sources.sh fmtlib highway googletest); then
  skip "libc++" "no sources of fmt, Highway and GoogleTest here"
else
  install_for_libcxx fmt "$sources/fmtlib" -DFMT_TEST=OFF -DFMT_DOC=OFF
  install_for_libcxx hwy "$sources/highway" -DHWY_ENABLE_TESTS=OFF -DHWY_ENABLE_EXAMPLES=OFF -DHWY_ENABLE_CONTRIB=OFF -DBUILD_TESTING=OFF
  scripts/hwy_package.sh "$root/build/compilers/libcxx-packages"
  install_for_libcxx gtest "$sources/googletest"
  CMAKE_PREFIX_PATH=$root/build/compilers/libcxx-packages check libcxx "$libcxx_compiler" -stdlib=libc++ "$@"
fi
exit $status
