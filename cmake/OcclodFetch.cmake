# Where dependencies come from that are not installed, with OCCLOD_FETCH_DEPENDENCIES: their authors' releases, each by the
# hash of its archive. The versions are those of Debian 12, which the tests run with. FETCHCONTENT_SOURCE_DIR_<NAME> names
# sources that are already here: scripts/check_doors.sh. scripts/sdist.py reads the declarations, in the form that they have.
include(FetchContent)

# Of some only headers are used: these have no folder of the name `none`, so that CMake unpacks and does nothing else.
FetchContent_Declare(glm
  URL https://github.com/g-truc/glm/archive/0.9.9.8.tar.gz
  URL_HASH SHA256=7d508ab72cb5d43227a3711420f06ff99b0a0cb63ee2f93631b162bfe1fe9592
  SOURCE_SUBDIR none FIND_PACKAGE_ARGS)
FetchContent_Declare(nlohmann_json
  URL https://github.com/nlohmann/json/archive/v3.11.2.tar.gz
  URL_HASH SHA256=d69f9deb6a75e2580465c6c4c5111b89c4dc2fa94e3a85fcd2ffcd9a143d9273
  SOURCE_SUBDIR none FIND_PACKAGE_ARGS)
FetchContent_Declare(CLI11
  URL https://github.com/CLIUtils/CLI11/archive/v2.1.2.tar.gz
  URL_HASH SHA256=26291377e892ba0e5b4972cdfd4a2ab3bf53af8dac1f4ea8fe0d1376b625c8cb
  SOURCE_SUBDIR none FIND_PACKAGE_ARGS)
FetchContent_Declare(xxhash
  URL https://github.com/Cyan4973/xxHash/archive/v0.8.1.tar.gz
  URL_HASH SHA256=3bb6b7d6f30c591dd65aaaff1c8b7a5b94d81687998ca9400082c739a690436c
  SOURCE_SUBDIR none)
FetchContent_Declare(stb
  URL https://github.com/nothings/stb/archive/8b5f1f37b5b75829fc72d38e7b5d4bcbf8a26d55.zip
  URL_HASH SHA256=93a16ee3e866e719feec459f6f132cce932c5ec751eb38e3ec1975f911353d2e
  SOURCE_SUBDIR none)
FetchContent_Declare(tinygltf
  URL https://github.com/syoyo/tinygltf/archive/v2.7.0.tar.gz
  URL_HASH SHA256=a1bbc0b831719e3a809a1bb01ce299a60e80b4e15221f58e822303ba22a69d45
  SOURCE_SUBDIR none)

FetchContent_Declare(fmt
  URL https://github.com/fmtlib/fmt/archive/9.1.0.tar.gz
  URL_HASH SHA256=5dea48d1fcddc3ec571ce2058e13910a0d4a6bab4cc09a809d8b1dd1c88ae6f2
  SYSTEM FIND_PACKAGE_ARGS)
FetchContent_Declare(hwy
  URL https://github.com/google/highway/archive/1.0.3.tar.gz
  URL_HASH SHA256=566fc77315878473d9a6bd815f7de78c73734acdcb745c3dde8579560ac5440e
  SYSTEM FIND_PACKAGE_ARGS)
FetchContent_Declare(zstd
  URL https://github.com/facebook/zstd/releases/download/v1.5.4/zstd-1.5.4.tar.gz
  URL_HASH SHA256=0f470992aedad543126d06efab344dc5f3e171893810455787d38347343a4424
  SOURCE_SUBDIR build/cmake SYSTEM FIND_PACKAGE_ARGS)

# The sdist of the Python package carries these sources: then nothing is fetched, and nothing of the system is used.
file(REAL_PATH ${CMAKE_CURRENT_LIST_DIR}/../third_party occlod_carried)
file(GLOB occlod_carried ${occlod_carried}/*)
foreach(folder IN LISTS occlod_carried)
  cmake_path(GET folder FILENAME name)
  string(TOUPPER FETCHCONTENT_SOURCE_DIR_${name} variable)
  set(${variable} ${folder} CACHE PATH "Sources that the sdist carries")
endforeach()

# occlod_find(NAME [TARGET target [INCLUDE folder]]): finds a package. One that is fetched becomes part of ours, and so is
# static; TARGET says that it consists of headers, which lie in INCLUDE.
macro(occlod_find name)
  if(OCCLOD_FETCH_DEPENDENCIES)
    occlod_find_or_fetch(${name} ${ARGN})
  else()
    find_package(${name} REQUIRED)
  endif()
endmacro()

function(occlod_find_or_fetch name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "TARGET;INCLUDE" "")
  set(BUILD_SHARED_LIBS OFF)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
  set(CMAKE_POLICY_DEFAULT_CMP0077 NEW)  # what is set here reaches projects that ask for an old CMake
  set(CMAKE_POLICY_DEFAULT_CMP0126 NEW)
  set(CMAKE_POLICY_VERSION_MINIMUM 3.5)  # and CMake 4 reads them
  set(CMAKE_WARN_DEPRECATED OFF)
  set(BUILD_TESTING OFF)
  set(HWY_ENABLE_CONTRIB OFF)
  set(HWY_ENABLE_EXAMPLES OFF)
  set(HWY_ENABLE_INSTALL OFF)
  set(HWY_ENABLE_TESTS OFF)
  set(ZSTD_BUILD_PROGRAMS OFF)
  set(ZSTD_BUILD_SHARED OFF)
  set(ZSTD_LEGACY_SUPPORT OFF)  # formats older than ours
  FetchContent_MakeAvailable(${name})
  FetchContent_GetProperties(${name} SOURCE_DIR source_dir)
  if(ARG_TARGET AND NOT TARGET ${ARG_TARGET})
    occlod_headers(${name} ${source_dir}/${ARG_INCLUDE})
    add_library(${ARG_TARGET} ALIAS occlod_${name})
  endif()
  if(TARGET hwy AND NOT TARGET hwy::hwy)
    add_library(hwy::hwy ALIAS hwy)  # the name that later versions and their packages use
  endif()
  if(name STREQUAL zstd AND TARGET libzstd_static)
    target_include_directories(libzstd_static SYSTEM INTERFACE $<BUILD_INTERFACE:${source_dir}/lib>)
  endif()
endfunction()

# occlod_find_header(NAME HEADER [option of find_path ...]): finds a library of headers that has no package, as occlod_NAME.
function(occlod_find_header name header)
  string(TOUPPER OCCLOD_${name}_HEADERS folder)
  string(TOUPPER FETCHCONTENT_SOURCE_DIR_${name} given)
  if(NOT OCCLOD_FETCH_DEPENDENCIES)
    find_path(${folder} ${header} ${ARGN} REQUIRED)
  elseif(NOT ${given} AND NOT FETCHCONTENT_TRY_FIND_PACKAGE_MODE STREQUAL NEVER)
    find_path(${folder} ${header} ${ARGN})
  endif()
  if(NOT ${folder})
    FetchContent_MakeAvailable(${name})
    FetchContent_GetProperties(${name} SOURCE_DIR ${folder})
  endif()
  occlod_headers(${name} ${${folder}})
endfunction()

function(occlod_headers name folder)
  add_library(occlod_${name} INTERFACE)
  target_include_directories(occlod_${name} SYSTEM INTERFACE ${folder})
endfunction()

# Installs the licences of what is compiled from its sources, each in a folder of its name.
function(occlod_install_licences destination)
  foreach(name IN ITEMS glm nlohmann_json CLI11 xxhash stb tinygltf fmt hwy zstd)
    FetchContent_GetProperties(${name} SOURCE_DIR source_dir)
    if(source_dir)
      file(GLOB licences LIST_DIRECTORIES OFF ${source_dir}/LICENSE* ${source_dir}/copying.txt)
      install(FILES ${licences} DESTINATION ${destination}/${name})
    endif()
  endforeach()
endfunction()
