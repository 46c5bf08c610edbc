# occlod_module(NAME SOURCES a.cpp ... [PUBLIC target ...] [PRIVATE target ...] [BUILD_ONLY target ...])
# One layer of the library, with its sources in lib/src and its headers in lib/include. In the build it is a static library
# of its own, occlod_NAME: the tests of a layer link it and the layers below it, so a layer that calls one above it does
# not link. occlod_library() joins the objects of the layers into what is installed.
# BUILD_ONLY dependencies are header-only and leave nothing behind. PRIVATE ones are linked by users of the static library
# too: cmake/occlodConfig.cmake.in and packaging/pkgconfig find them.
function(occlod_module name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;PUBLIC;PRIVATE;BUILD_ONLY")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "occlod_module(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  # Layers not by occlod::NAME, which is the shared library where one is built.
  get_property(layers GLOBAL PROPERTY OCCLOD_LAYERS)
  set(layer_targets ${layers})
  list(TRANSFORM layer_targets PREPEND occlod_)
  foreach(layer IN LISTS layers)
    list(TRANSFORM ARG_PUBLIC REPLACE "^occlod::${layer}$" occlod_${layer})
    list(TRANSFORM ARG_PRIVATE REPLACE "^occlod::${layer}$" occlod_${layer})
  endforeach()

  add_library(occlod_${name} STATIC ${ARG_SOURCES})
  set_target_properties(occlod_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)  # the same objects for either kind
  target_compile_features(occlod_${name} PUBLIC cxx_std_20)
  target_compile_options(occlod_${name} PRIVATE ${OCCLOD_ARITHMETIC_FLAGS})
  target_include_directories(occlod_${name} PUBLIC ${PROJECT_SOURCE_DIR}/lib/include PRIVATE ${PROJECT_SOURCE_DIR}/lib/src)
  target_link_libraries(occlod_${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} ${ARG_BUILD_ONLY} occlod_warnings)

  # For occlod_library().
  set_property(GLOBAL APPEND PROPERTY OCCLOD_LAYERS ${name})
  list(REMOVE_ITEM ARG_PUBLIC ${layer_targets})
  list(REMOVE_ITEM ARG_PRIVATE ${layer_targets})
  set_target_properties(occlod_${name} PROPERTIES
    OCCLOD_PUBLIC_DEPENDENCIES "${ARG_PUBLIC}" OCCLOD_PRIVATE_DEPENDENCIES "${ARG_PRIVATE}")
endfunction()

# occlod_hash_sources(LAYER NAME [LAYERS layer ...] [FILES file ...])
# Makes the header LAYER/NAME.h, for the sources of that layer: the constant NAME, a hash of all sources and public
# headers of the layers named, and of the files.
function(occlod_hash_sources layer name)
  cmake_parse_arguments(PARSE_ARGV 2 ARG "" "" "FILES;LAYERS")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "occlod_hash_sources(${layer} ${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  set(patterns "")
  foreach(other IN LISTS ARG_LAYERS)
    list(APPEND patterns ${PROJECT_SOURCE_DIR}/lib/src/${other}/* ${PROJECT_SOURCE_DIR}/lib/include/occlod/${other}/*.h)
  endforeach()
  file(GLOB files CONFIGURE_DEPENDS ${patterns})
  list(APPEND files ${ARG_FILES})
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/generated)
  add_custom_command(
    OUTPUT ${folder}/${layer}/${name}.h
    COMMAND ${CMAKE_COMMAND} "-DFILES=${files}" -DNAME=${name} -DOUTPUT=${folder}/${layer}/${name}.h
            -P ${PROJECT_SOURCE_DIR}/cmake/HashSources.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/HashSources.cmake
    COMMENT "Hashing the sources that decide ${name}"
    VERBATIM)
  target_sources(occlod_${layer} PRIVATE ${folder}/${layer}/${name}.h)
  target_include_directories(occlod_${layer} PRIVATE ${folder})
endfunction()
