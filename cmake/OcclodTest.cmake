# How tests are registered: each with labels, which ctest -L and the test presets choose by.
#   unit    one layer of the library or one part of a program: no OpenGL, no display, seconds
#   gl      needs an OpenGL context          viewer  the viewer's programs, on a virtual display
#   meshes  reads real meshes where there are any
#   tools   programs as people start them    slow    left out by scripts/test.sh --quick
# and the name of its folder under tests/. scripts/count_tests.py counts the single tests.
set(OCCLOD_TEST_TIMEOUT 600 CACHE STRING "Seconds that one entry of ctest may take")
# Saves a second for each of 150 sources, and hides includes that they lack: scripts/test_clang.sh and the other presets do
# without it.
option(OCCLOD_TEST_PCH "Compile the tests with a precompiled header of GoogleTest and the C++ library" OFF)
set(OCCLOD_GTEST_RESULTS ${PROJECT_BINARY_DIR}/Testing/gtest)  # where GoogleTest writes which of its tests ran

# occlod_label_tests(NAME... LABELS label...): labels and time limit for entries of ctest.
function(occlod_label_tests)
  cmake_parse_arguments(PARSE_ARGV 0 ARG "" "" "LABELS")
  get_filename_component(folder ${CMAKE_CURRENT_SOURCE_DIR} NAME)
  foreach(test IN LISTS ARG_UNPARSED_ARGUMENTS)
    set_property(TEST ${test} APPEND PROPERTY LABELS ${ARG_LABELS} ${folder})
    set_property(TEST ${test} APPEND PROPERTY ENVIRONMENT "GTEST_OUTPUT=xml:${OCCLOD_GTEST_RESULTS}/${test}.xml")
    set_property(TEST ${test} PROPERTY TIMEOUT ${OCCLOD_TEST_TIMEOUT})
  endforeach()
endfunction()

# occlod_test(NAME SOURCES a.cpp ... LIBRARIES target ... [LABELS label ...] [SLOW filter]): one GoogleTest program and one
# entry of ctest, labelled `unit` if not told otherwise.
# SLOW: a --gtest_filter for what is an entry of its own, NAME.slow, with the label `slow` instead of `unit`.
function(occlod_test name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "SLOW" "SOURCES;LIBRARIES;LABELS")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "occlod_test(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  set(labels ${ARG_LABELS})
  add_executable(test_${name} ${ARG_SOURCES})
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests ${PROJECT_SOURCE_DIR}/lib)
  target_link_libraries(test_${name} PRIVATE ${ARG_LIBRARIES} occlod_warnings GTest::gtest_main)
  # They are compiled longer than they run; what they test keeps its own options.
  target_compile_options(test_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  occlod_precompile_test(test_${name})

  if(ARG_SLOW)
    add_test(NAME ${name} COMMAND test_${name} --gtest_filter=-${ARG_SLOW})
    add_test(NAME ${name}.slow COMMAND test_${name} --gtest_filter=${ARG_SLOW})
    list(REMOVE_ITEM ARG_LABELS unit)
    occlod_label_tests(${name}.slow LABELS slow ${ARG_LABELS})
    set_property(TEST ${name}.slow PROPERTY COST 100)  # first, so that a core is not left alone with it at the end
  else()
    add_test(NAME ${name} COMMAND test_${name})
  endif()
  occlod_label_tests(${name} LABELS ${labels})
endfunction()

# All test programs are compiled alike, so that they share one precompiled header.
function(occlod_precompile_test target)
  if(NOT OCCLOD_TEST_PCH)
    return()
  endif()
  if(NOT TARGET occlod_test_pch)
    file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/tests/pch.cpp CONTENT "")
    add_library(occlod_test_pch OBJECT ${PROJECT_BINARY_DIR}/tests/pch.cpp)
    target_link_libraries(occlod_test_pch PRIVATE occlod_warnings GTest::gtest_main glm::glm)
    target_compile_features(occlod_test_pch PRIVATE cxx_std_20)
    target_compile_options(occlod_test_pch PRIVATE $<$<CONFIG:Release>:-O1>)
    target_precompile_headers(occlod_test_pch PRIVATE
      <gtest/gtest.h> <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional> <limits> <map> <memory>
      <numeric> <optional> <random> <set> <span> <sstream> <string> <string_view> <utility> <variant> <vector> <glm/glm.hpp>)
  endif()
  target_precompile_headers(${target} REUSE_FROM occlod_test_pch)
endfunction()
