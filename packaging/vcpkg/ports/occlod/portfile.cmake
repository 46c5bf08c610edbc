# The sources are the tree that this port lies in: vcpkg install occlod --overlay-ports=packaging/vcpkg/ports
get_filename_component(SOURCE_PATH "${CURRENT_PORT_DIR}/../../../.." ABSOLUTE)

vcpkg_check_features(OUT_FEATURE_OPTIONS feature_options
  FEATURES
    gl OCCLOD_BUILD_GL
    tools OCCLOD_BUILD_TOOLS)
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    ${feature_options}
    -DOCCLOD_BUILD_TESTS=OFF
    -DOCCLOD_BUILD_VIEWER=OFF
    -DOCCLOD_WARNINGS_AS_ERRORS=OFF
    -DOCCLOD_WITH_CGAL=OFF
    -DOCCLOD_WITH_MESHOPTIMIZER=OFF
    -DOCCLOD_WITH_OPENMESH=OFF
    -DOCCLOD_WITH_ZLIB=OFF)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/occlod)
vcpkg_fixup_pkgconfig()
if("tools" IN_LIST FEATURES)
  vcpkg_copy_tools(TOOL_NAMES occlod AUTO_CLEAN)
endif()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share")
file(INSTALL "${CMAKE_CURRENT_LIST_DIR}/usage" DESTINATION "${CURRENT_PACKAGES_DIR}/share/${PORT}")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE")
