# occlod_library(TARGET NAME name FILE_NAME name ROOMS room ... [PUBLIC target ...])
# One installed library, static or shared by BUILD_SHARED_LIBS, made of the objects of its rooms; occlod::NAME to those
# who use it. The interface of a 0.x version may change with every minor version: the name of the shared library has both.
function(occlod_library target)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "NAME;FILE_NAME" "ROOMS;PUBLIC")
  add_library(${target})
  add_library(occlod::${ARG_NAME} ALIAS ${target})
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${ARG_NAME} OUTPUT_NAME ${ARG_FILE_NAME} LINKER_LANGUAGE CXX
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/lib/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC})
  foreach(room IN LISTS ARG_ROOMS)
    target_sources(${target} PRIVATE $<TARGET_OBJECTS:occlod_${room}>)
    get_target_property(public occlod_${room} OCCLOD_PUBLIC_DEPENDENCIES)
    get_target_property(private occlod_${room} OCCLOD_PRIVATE_DEPENDENCIES)
    target_link_libraries(${target} PUBLIC ${public} PRIVATE ${private})
  endforeach()
  if(BUILD_SHARED_LIBS)
    occlod_export_symbols(${target})
  endif()
endfunction()

# Exports what lies in namespace occlod, and nothing of fmt, tinygltf or the standard library that was compiled along; calls
# inside the library go straight to their function. Done when linking, so that headers need no export macros and both kinds
# of library are made of the same objects. Private parts are exported too, though their headers are not installed: the
# tests, the viewer and the benchmarks use some of them. The library stays loaded once it has been: threads of its pool
# may be in it when a plugin that uses it is unloaded.
function(occlod_export_symbols target)
  set(script ${PROJECT_SOURCE_DIR}/lib/exports.map)
  set(options LINKER:--version-script=${script} LINKER:-Bsymbolic-functions LINKER:-z,nodelete)
  include(CheckLinkerFlag)
  check_linker_flag(CXX "${options}" OCCLOD_LINKER_CHOOSES_EXPORTS)
  if(OCCLOD_LINKER_CHOOSES_EXPORTS)
    target_link_options(${target} PRIVATE ${options})
    set_target_properties(${target} PROPERTIES LINK_DEPENDS ${script})
  endif()
endfunction()
