#!/usr/bin/env bash
# check_doors.sh: the library and the command line built against dependencies as their authors build them, and against none
# installed, with OCCLOD_FETCH_DEPENDENCIES. Offline: the sources are those of Debian's source packages, without Debian's
# patches (scripts/debian_sources.sh). Works in build/doors. Says SKIPPED, with exit status 77, where they cannot be had.
set -euo pipefail
cd "$(dirname "$0")/.."

work=$PWD/build/doors
prefix=$work/upstream
mkdir -p "$work"

# What a command prints is shown when it fails.
quietly() { "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }; }

# Nothing of Debian's packages: the system's folders are not searched, but for those beside PATH (check_origins).
# Compiled without optimisation: it is to link.
configure() { quietly cmake -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF "$@"; }
configure_occlod() {
  configure -S . "$@" -DOCCLOD_BUILD_TESTS=OFF -DOCCLOD_WITH_CGAL=OFF -DOCCLOD_WITH_OPENMESH=OFF -DOCCLOD_BUILD_GL=OFF \
    -DOCCLOD_BUILD_VIEWER=OFF
}

# Fails when the build in the folder $1 has found a package of the dependencies in the system, as beside the programs of
# PATH, or when a compilation has read a header from there.
check_origins() {
  local foreign
  foreign=$(
    grep -E '^((CLI11|fmt|glm|hwy|nlohmann_json|zstd)_DIR|OCCLOD_[A-Z]+_HEADERS):PATH=/usr/' "$1/CMakeCache.txt" || true
    ninja -C "$1" -t deps | grep -E '^ +/usr/include/(CLI|fmt|glm|hwy|nlohmann|stb|tiny_gltf|xxhash|zstd)' | sort -u || true
  )
  [ -z "$foreign" ] || { printf 'check_doors: these came from the system:\n%s\n' "$foreign" >&2; exit 1; }
}

install_upstream() {
  local package=$1 folder=$2
  shift 2
  configure -S "$sources/$package/$folder" -B "$work/$package" "-DCMAKE_INSTALL_PREFIX=$prefix" "-DCMAKE_PREFIX_PATH=$prefix" "$@"
  quietly cmake --build "$work/$package" --target install
}

if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
if ! sources=$(scripts/debian_sources.sh cli11 fmtlib glm highway libstb libzstd nlohmann-json3 tinygltf xxhash); then
  echo "check_doors: SKIPPED" >&2
  exit 77
fi

echo "== upstream's packages, static libraries"
install_upstream cli11 . -DCLI11_BUILD_TESTS=OFF -DCLI11_BUILD_EXAMPLES=OFF -DCLI11_BUILD_DOCS=OFF
install_upstream fmtlib . -DFMT_TEST=OFF -DFMT_DOC=OFF
install_upstream highway . -DHWY_ENABLE_TESTS=OFF -DHWY_ENABLE_EXAMPLES=OFF -DHWY_ENABLE_CONTRIB=OFF -DBUILD_TESTING=OFF
scripts/hwy_package.sh "$prefix"
install_upstream libzstd build/cmake -DZSTD_BUILD_SHARED=OFF -DZSTD_BUILD_PROGRAMS=OFF
install_upstream nlohmann-json3 . -DJSON_BuildTests=OFF
# These authors install headers, or nothing.
mkdir -p "$prefix/include" "$prefix/lib/cmake/glm"
cp "$sources/tinygltf/tiny_gltf.h" "$sources/xxhash/xxhash.h" "$sources"/libstb/stb_image*.h "$prefix/include"
cp -r "$sources/glm/glm" "$prefix/include"
echo 'add_library(glm::glm INTERFACE IMPORTED)
target_include_directories(glm::glm INTERFACE ${CMAKE_CURRENT_LIST_DIR}/../../../include)' >"$prefix/lib/cmake/glm/glmConfig.cmake"

configure_occlod -B "$work/on-upstream" "-DCMAKE_PREFIX_PATH=$prefix" "-DCMAKE_INSTALL_PREFIX=$work/installed"
quietly cmake --build "$work/on-upstream" --target install
check_origins "$work/on-upstream"
"$work/installed/bin/occlod" --version
configure -S tests/consumer/project -B "$work/consumer" "-DCMAKE_PREFIX_PATH=$work/installed;$prefix"
quietly cmake --build "$work/consumer"
check_origins "$work/consumer"
(cd "$work/consumer" && ./consumer)

echo "== nothing installed, in a project that includes occlod"
fetched=(-DOCCLOD_FETCH_DEPENDENCIES=ON -DFETCHCONTENT_FULLY_DISCONNECTED=ON -DFETCHCONTENT_TRY_FIND_PACKAGE_MODE=NEVER)
for pair in CLI11=cli11 FMT=fmtlib GLM=glm HWY=highway STB=libstb ZSTD=libzstd NLOHMANN_JSON=nlohmann-json3 TINYGLTF=tinygltf XXHASH=xxhash; do
  fetched+=("-DFETCHCONTENT_SOURCE_DIR_${pair%=*}=$sources/${pair#*=}")
done
configure -S tests/consumer/subproject -B "$work/subproject" "-DOCCLOD_SOURCE_DIR=$PWD" -DOCCLOD_BUILD_TOOLS=ON -DOCCLOD_WITH_CGAL=OFF \
  -DOCCLOD_WITH_OPENMESH=OFF "${fetched[@]}"
quietly cmake --build "$work/subproject" --target consumer occlod_tool
check_origins "$work/subproject"
(cd "$work/subproject" && ./consumer && ./occlod/tools/occlod --version)
echo "check_doors: passed"
