# Compiles sources in groups, each a source that includes up to OCCLOD_UNITY_MOST of them: most of the time goes to the headers of the
# C++ library, GoogleTest, CLI11 and JSON. That hides includes that sources lack, names in one file shadow those of another,
# and one change compiles a whole group again, so the presets for development do not ask for it, but those of what is
# measured, installed and tested do, and the Python package. Targets whose property UNITY_BUILD says OFF are compiled as ever.
set(OCCLOD_UNITY_MOST 8 CACHE STRING "The most sources of a group")
option(OCCLOD_UNITY "Compile sources in groups, in about half of the processor time" OFF)

# Groups the sources of all targets of the project, after the last of them.
function(occlod_compile_in_groups)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
  set(pairs "")
  get_property(folders DIRECTORY ${PROJECT_SOURCE_DIR} PROPERTY SUBDIRECTORIES)
  foreach(folder IN LISTS folders)
    occlod_list_sources(${folder} pairs)
  endforeach()
  set(list ${PROJECT_BINARY_DIR}/unity_sources.txt)
  set(groups ${PROJECT_BINARY_DIR}/unity_groups.cmake)
  file(WRITE ${list} "${pairs}")
  execute_process(COMMAND ${Python3_EXECUTABLE} -B ${PROJECT_SOURCE_DIR}/scripts/source_groups.py ${OCCLOD_UNITY_MOST}
                  INPUT_FILE ${list} OUTPUT_FILE ${groups} COMMAND_ERROR_IS_FATAL ANY)
  include(${groups})
endfunction()

# Appends "target source" lines to the variable; prepares the targets.
function(occlod_list_sources folder variable)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  get_property(below DIRECTORY ${folder} PROPERTY SUBDIRECTORIES)
  set(lines "${${variable}}")
  foreach(target IN LISTS targets)
    get_target_property(type ${target} TYPE)
    get_target_property(sources ${target} SOURCES)
    get_target_property(source_dir ${target} SOURCE_DIR)
    get_target_property(unity ${target} UNITY_BUILD)
    if(NOT type MATCHES "EXECUTABLE|LIBRARY" OR NOT sources OR unity STREQUAL OFF)
      continue()
    endif()
    # Each file of a group has an Options of its own.
    set_target_properties(${target} PROPERTIES
      UNITY_BUILD ON UNITY_BUILD_MODE GROUP UNITY_BUILD_UNIQUE_ID OCCLOD_UNITY_ID
      UNITY_BUILD_CODE_BEFORE_INCLUDE
        "#pragma GCC diagnostic ignored \"-Wshadow\"\n#define OCCLOD_UNITY_PASTE(name, id) name##_##id\n#define OCCLOD_UNITY_NAME(name, id) OCCLOD_UNITY_PASTE(name, id)\n#define Options OCCLOD_UNITY_NAME(Options, OCCLOD_UNITY_ID)"
      UNITY_BUILD_CODE_AFTER_INCLUDE "#undef Options\n#undef OCCLOD_UNITY_NAME\n#undef OCCLOD_UNITY_PASTE")
    # Types with members from anonymous namespaces would matter in headers.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
    foreach(source IN LISTS sources)
      cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${source_dir} NORMALIZE)
      if(source MATCHES "\\.cpp$" AND EXISTS ${source} AND NOT source MATCHES "^${PROJECT_BINARY_DIR}/")
        string(APPEND lines "${target} ${source}\n")
      endif()
    endforeach()
  endforeach()
  foreach(child IN LISTS below)
    occlod_list_sources(${child} lines)
  endforeach()
  set(${variable} "${lines}" PARENT_SCOPE)
endfunction()
