# The targets that consumers name, and the installed package: occlod::occlod = every layer that needs no GL,
# occlod::gl = the OpenGL backends.
get_property(occlod_modules GLOBAL PROPERTY OCCLOD_MODULES)
set(occlod_portable_modules ${occlod_modules})
list(REMOVE_ITEM occlod_portable_modules occlod_gl)

add_library(occlod_occlod INTERFACE)
add_library(occlod::occlod ALIAS occlod_occlod)
set_target_properties(occlod_occlod PROPERTIES EXPORT_NAME occlod)
target_link_libraries(occlod_occlod INTERFACE ${occlod_portable_modules})

if(OCCLOD_INSTALL)
  include(CMakePackageConfigHelpers)
  set(occlod_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/occlod)
  configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/occlodConfig.cmake.in ${PROJECT_BINARY_DIR}/occlodConfig.cmake
    INSTALL_DESTINATION ${occlod_package_dir} NO_SET_AND_CHECK_MACRO)
  write_basic_package_version_file(${PROJECT_BINARY_DIR}/occlodConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${PROJECT_BINARY_DIR}/occlodConfig.cmake ${PROJECT_BINARY_DIR}/occlodConfigVersion.cmake
          DESTINATION ${occlod_package_dir})
  install(TARGETS ${occlod_modules} occlod_occlod EXPORT occlodTargets)
  install(EXPORT occlodTargets NAMESPACE occlod:: DESTINATION ${occlod_package_dir})
  install(DIRECTORY lib/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  if(OCCLOD_BUILD_TOOLS)
    install(TARGETS occlod_tool)
  endif()
  if(OCCLOD_BUILD_VIEWER)
    install(TARGETS occlod_view)
  endif()
endif()
