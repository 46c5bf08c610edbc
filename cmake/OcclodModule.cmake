# occlod_module(NAME HEADERS a.h ... SOURCES a.cpp ... [PUBLIC target ...] [PRIVATE target ...] [BUILD_ONLY target ...])
# One room of the library: its sources and private headers lie in lib/NAME, its public headers, HEADERS, in
# lib/include/occlod. In the build it is a static library of its own, occlod_NAME, which links the rooms that it uses and no other: one that calls what
# stands below it in lib/CMakeLists.txt does not link. occlod_library() joins the objects of the rooms into what is installed.
# BUILD_ONLY dependencies are header-only and leave nothing behind. PRIVATE ones are linked by users of the static library
# too: cmake/occlodConfig.cmake.in and packaging/pkgconfig find them.
function(occlod_module name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "HEADERS;SOURCES;PUBLIC;PRIVATE;BUILD_ONLY")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "occlod_module(${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  # Rooms not by occlod::NAME, which is the shared library where one is built.
  get_property(rooms GLOBAL PROPERTY OCCLOD_ROOMS)
  set(room_targets ${rooms})
  list(TRANSFORM room_targets PREPEND occlod_)
  foreach(room IN LISTS rooms)
    list(TRANSFORM ARG_PUBLIC REPLACE "^occlod::${room}$" occlod_${room})
    list(TRANSFORM ARG_PRIVATE REPLACE "^occlod::${room}$" occlod_${room})
  endforeach()

  list(TRANSFORM ARG_HEADERS PREPEND ${PROJECT_SOURCE_DIR}/lib/include/occlod/)
  add_library(occlod_${name} STATIC ${ARG_SOURCES} ${ARG_HEADERS})
  set_target_properties(occlod_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)  # the same objects for either kind
  target_compile_features(occlod_${name} PUBLIC cxx_std_20)
  target_compile_options(occlod_${name} PRIVATE ${OCCLOD_ARITHMETIC_FLAGS} ${OCCLOD_LIBRARY_FLAGS})
  target_include_directories(occlod_${name} PUBLIC ${PROJECT_SOURCE_DIR}/lib/include PRIVATE ${PROJECT_SOURCE_DIR}/lib)
  target_link_libraries(occlod_${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} ${ARG_BUILD_ONLY} occlod_warnings)

  # For occlod_library().
  set_property(GLOBAL APPEND PROPERTY OCCLOD_ROOMS ${name})
  list(REMOVE_ITEM ARG_PUBLIC ${room_targets})
  list(REMOVE_ITEM ARG_PRIVATE ${room_targets})
  set_target_properties(occlod_${name} PROPERTIES
    OCCLOD_PUBLIC_DEPENDENCIES "${ARG_PUBLIC}" OCCLOD_PRIVATE_DEPENDENCIES "${ARG_PRIVATE}")
endfunction()

# occlod_hash_sources(ROOM NAME FOLDERS folder ... [FILES file ...])
# Makes the header ROOM/NAME.h, for the sources of that room: the constant NAME, a hash of all public headers, of the sources
# in the folders of lib/ that are named, and of the files.
function(occlod_hash_sources room name)
  cmake_parse_arguments(PARSE_ARGV 2 ARG "" "" "FILES;FOLDERS")
  if(ARG_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "occlod_hash_sources(${room} ${name}): unknown arguments ${ARG_UNPARSED_ARGUMENTS}")
  endif()
  set(patterns "")
  foreach(other IN LISTS ARG_FOLDERS)
    list(APPEND patterns ${PROJECT_SOURCE_DIR}/lib/${other}/*.h ${PROJECT_SOURCE_DIR}/lib/${other}/*.cpp)
  endforeach()
  file(GLOB files CONFIGURE_DEPENDS ${patterns})
  file(GLOB_RECURSE headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/lib/include/*.h)
  list(APPEND files ${headers} ${ARG_FILES})
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/generated)
  add_custom_command(
    OUTPUT ${folder}/${room}/${name}.h
    COMMAND ${CMAKE_COMMAND} "-DFILES=${files}" -DNAME=${name} -DOUTPUT=${folder}/${room}/${name}.h
            -P ${PROJECT_SOURCE_DIR}/cmake/HashSources.cmake
    DEPENDS ${files} ${PROJECT_SOURCE_DIR}/cmake/HashSources.cmake
    COMMENT "Hashing the sources that decide ${name}"
    VERBATIM)
  target_sources(occlod_${room} PRIVATE ${folder}/${room}/${name}.h)
  target_include_directories(occlod_${room} PRIVATE ${folder})
endfunction()
