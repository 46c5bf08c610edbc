#!/usr/bin/env bash
# hwy_package.sh PREFIX: the package for CMake of a static Highway that is installed in PREFIX. Its authors install one from
# version 1.0.4 on; Debian 12 has 1.0.3, with a patch that adds it.
set -euo pipefail

folder=$1/lib/cmake/hwy
mkdir -p "$folder"
cat >"$folder/hwy-config.cmake" <<'END'
add_library(hwy::hwy STATIC IMPORTED)
set_target_properties(hwy::hwy PROPERTIES IMPORTED_LOCATION ${CMAKE_CURRENT_LIST_DIR}/../../libhwy.a
  INTERFACE_INCLUDE_DIRECTORIES ${CMAKE_CURRENT_LIST_DIR}/../../../include)
END
