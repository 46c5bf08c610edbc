#!/usr/bin/env bash
# with_pkg_config.sh FOLDER LIBDIR: compiles the programs in FOLDER with what pkg-config says about the libraries in LIBDIR,
# static or shared, and runs them. Writes into the working directory.
set -euo pipefail

folder=$1
libdir=$2
if ! command -v pkg-config >/dev/null; then echo "skipped: pkg-config is not here"; exit 77; fi
export PKG_CONFIG_PATH=$libdir/pkgconfig
export LD_LIBRARY_PATH=$libdir${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
static=(--static)
if compgen -G "$libdir/libocclod.so*" >/dev/null; then static=(); fi

build_and_run() {
  local program=$1 source=$2 package=$3
  local -a flags
  read -ra flags < <(pkg-config --cflags --libs "${static[@]}" "$package")
  # shellcheck disable=SC2086  # flags are words
  ${CXX:-c++} ${CXXFLAGS:-} -std=c++20 "$folder/$source" -o "$program" "${flags[@]}"
  "./$program"
}

build_and_run consumer_of_pc main.cpp occlod
if pkg-config --exists occlod_gl; then build_and_run gl_consumer_of_pc gl_main.cpp occlod_gl; fi
