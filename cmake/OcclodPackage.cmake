# What `cmake --install` installs: the libraries and their headers, a CMake package with the targets occlod::occlod and
# occlod::gl, the same for pkg-config, the licence and the programs.
if(NOT OCCLOD_INSTALL)
  return()
endif()

set(occlod_libraries occlod_library)
set(occlod_headers_left_out "")
if(OCCLOD_BUILD_GL)
  list(APPEND occlod_libraries occlod_gl_library)
else()
  list(APPEND occlod_headers_left_out PATTERN gl EXCLUDE)
endif()
if(NOT OCCLOD_WITH_OPENMESH)
  list(APPEND occlod_headers_left_out PATTERN interop EXCLUDE)
endif()
install(TARGETS ${occlod_libraries} EXPORT occlodTargets)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/lib/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} ${occlod_headers_left_out})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

include(CMakePackageConfigHelpers)
set(occlod_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/occlod)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/occlodConfig.cmake.in ${PROJECT_BINARY_DIR}/occlodConfig.cmake
  INSTALL_DESTINATION ${occlod_package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/occlodConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/occlodConfig.cmake ${PROJECT_BINARY_DIR}/occlodConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/OcclodZstd.cmake
        DESTINATION ${occlod_package_dir})
install(EXPORT occlodTargets NAMESPACE occlod:: DESTINATION ${occlod_package_dir})

# The files for pkg-config find the rest from where they lie, so that an installation may be moved. GLM has one of its own
# in some distributions only.
set(occlod_pkgconfig_dir ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
file(RELATIVE_PATH occlod_pc_prefix /prefix/${occlod_pkgconfig_dir} /prefix/)
string(REGEX REPLACE "/$" "" occlod_pc_prefix "${occlod_pc_prefix}")
list(TRANSFORM CMAKE_DL_LIBS PREPEND "-l" OUTPUT_VARIABLE occlod_pc_dl)
set(occlod_pc_requires "")
find_package(PkgConfig QUIET)
if(PkgConfig_FOUND)
  pkg_check_modules(occlod_pc_glm QUIET glm)
  if(occlod_pc_glm_FOUND)
    set(occlod_pc_requires glm)
  endif()
endif()
set(occlod_pc_files occlod.pc)
if(OCCLOD_BUILD_GL)
  list(APPEND occlod_pc_files occlod_gl.pc)
endif()
foreach(file IN LISTS occlod_pc_files)
  configure_file(${PROJECT_SOURCE_DIR}/packaging/pkgconfig/${file}.in ${PROJECT_BINARY_DIR}/${file} @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${file} DESTINATION ${occlod_pkgconfig_dir})
endforeach()

if(OCCLOD_BUILD_TOOLS)
  install(TARGETS occlod_tool)
endif()
if(OCCLOD_BUILD_VIEWER)
  install(TARGETS occlod_view)
endif()
