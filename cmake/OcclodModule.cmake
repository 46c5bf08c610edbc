# occlod_module(NAME SOURCES a.cpp ... [PUBLIC target ...] [PRIVATE target ...] [BUILD_ONLY target ...])
# One layer of the library: a static library occlod_NAME, known as occlod::NAME, with its headers in lib/include.
# PRIVATE dependencies are linked by consumers too (the library is static): cmake/occlodConfig.cmake.in finds them.
# BUILD_ONLY ones are header-only and leave nothing behind.
function(occlod_module name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;PUBLIC;PRIVATE;BUILD_ONLY")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "occlod_module(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  list(TRANSFORM ARG_BUILD_ONLY REPLACE "(.+)" "$<BUILD_INTERFACE:\\1>")

  add_library(occlod_${name} STATIC ${ARG_SOURCES})
  add_library(occlod::${name} ALIAS occlod_${name})
  set_target_properties(occlod_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(occlod_${name} PUBLIC cxx_std_20)
  # No fused multiply-add that the source does not ask for: results are the same on every machine with IEEE arithmetic.
  # Nobody looks at errno or at floating-point traps, so roots and conditions on floats may be compiled to instructions.
  target_compile_options(occlod_${name} PRIVATE -ffp-contract=off -fno-math-errno -fno-trapping-math)
  target_include_directories(occlod_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/lib/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR}/lib/src)
  target_link_libraries(occlod_${name}
    PUBLIC ${ARG_PUBLIC}
    PRIVATE ${ARG_PRIVATE} ${ARG_BUILD_ONLY} $<BUILD_INTERFACE:occlod_warnings>)
  set_property(GLOBAL APPEND PROPERTY OCCLOD_MODULES occlod_${name})
endfunction()

# occlod_test(NAME SOURCES a.cpp ... LIBRARIES target ...): one GoogleTest program, one ctest per TEST.
function(occlod_test name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;LIBRARIES")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "occlod_test(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  add_executable(test_${name} ${ARG_SOURCES})
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests ${PROJECT_SOURCE_DIR}/lib/src)
  target_link_libraries(test_${name} PRIVATE ${ARG_LIBRARIES} occlod_warnings GTest::gtest_main)
  # They are compiled longer than they run; what they test keeps its own options.
  target_compile_options(test_${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  gtest_discover_tests(test_${name} PROPERTIES TIMEOUT 600 DISCOVERY_TIMEOUT 60)
endfunction()
