# Every third-party package, in one place. scripts/packages.txt lists the Debian packages that bring them; with
# OCCLOD_FETCH_DEPENDENCIES what the library and the command line miss is fetched.
include(OcclodFetch)
find_package(Threads REQUIRED)
occlod_find(glm TARGET glm::glm)
occlod_find(fmt)
occlod_find(nlohmann_json TARGET nlohmann_json::nlohmann_json INCLUDE include)

occlod_find(zstd)
include(OcclodZstd)

# Highway compiles our vector code for plain C++, SSSE3, AVX2 and AVX-512 (NEON on ARM) and chooses at run time. What lies
# between gains nothing here; vectors whose size only the machine knows cannot be halved as we do.
occlod_find(hwy)
set(OCCLOD_HWY_TARGETS "HWY_DISABLED_TARGETS=(HWY_SSE4|HWY_AVX3_DL|HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128)")

# These are compiled from their headers, in sources of ours, and leave nothing to link.
occlod_find_header(stb stb_image_write.h PATH_SUFFIXES stb)
occlod_find_header(tinygltf tiny_gltf.h)
occlod_find_header(xxhash xxhash.h)
target_compile_definitions(occlod_xxhash INTERFACE XXH_INLINE_ALL)

if(OCCLOD_WITH_OPENMESH)
  find_package(OpenMesh REQUIRED)
endif()
# Decodes and encodes EXT_meshopt_compression; files with it are refused, and not written, without.
set(OCCLOD_MESHOPTIMIZER "")
if(OCCLOD_WITH_MESHOPTIMIZER)
  find_package(meshoptimizer REQUIRED)
  set(OCCLOD_MESHOPTIMIZER meshoptimizer::meshoptimizer)
endif()
# Packs PNG images in two thirds of the bytes that stb needs.
set(OCCLOD_ZLIB "")
if(OCCLOD_WITH_ZLIB)
  find_package(ZLIB REQUIRED)
  set(OCCLOD_ZLIB ZLIB::ZLIB)
endif()
if(OCCLOD_BUILD_TOOLS OR OCCLOD_BUILD_VIEWER OR OCCLOD_BUILD_BENCH)
  occlod_find(CLI11 TARGET CLI11::CLI11 INCLUDE include)
endif()
if(OCCLOD_BUILD_TOOLS AND OCCLOD_WITH_SERVER)
  find_package(Boost 1.70 REQUIRED)  # Asio and Beast, which are headers
endif()
if(OCCLOD_BUILD_TOOLS AND OCCLOD_WITH_PROJ)
  find_path(OCCLOD_PROJ_INCLUDE_DIR proj.h REQUIRED)
endif()
if(OCCLOD_BUILD_VIEWER)
  find_package(glfw3 REQUIRED)
  # With the backends for GLFW and OpenGL.
  find_package(imgui CONFIG QUIET)
  add_library(occlod_imgui INTERFACE)
  if(TARGET imgui::imgui)
    target_link_libraries(occlod_imgui INTERFACE imgui::imgui)
  else()  # Debian's has no package for CMake, and needs stb
    find_path(OCCLOD_IMGUI_INCLUDE_DIR imgui.h PATH_SUFFIXES imgui REQUIRED)
    find_library(OCCLOD_IMGUI_LIBRARY imgui REQUIRED)
    find_library(OCCLOD_STB_LIBRARY stb REQUIRED)
    target_include_directories(occlod_imgui SYSTEM INTERFACE ${OCCLOD_IMGUI_INCLUDE_DIR})
    target_link_libraries(occlod_imgui INTERFACE ${OCCLOD_IMGUI_LIBRARY} ${OCCLOD_STB_LIBRARY} ${CMAKE_DL_LIBS})
  endif()
endif()
if(OCCLOD_WITH_CGAL AND (OCCLOD_BUILD_TOOLS OR OCCLOD_BUILD_BENCH))
  set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE ON)
  set(occlod_module_path ${CMAKE_MODULE_PATH})
  find_package(CGAL QUIET)
  set(CMAKE_MODULE_PATH ${occlod_module_path})  # CGAL puts its own search modules for OpenMesh and others in front
  if(NOT CGAL_FOUND)
    message(FATAL_ERROR "CGAL was not found: install it (libcgal-dev), or configure with -DOCCLOD_WITH_CGAL=OFF and go without `occlod compare` and `occlod repair`")
  endif()
endif()
if(OCCLOD_BUILD_BENCH)
  find_package(benchmark REQUIRED)
  # The peers that we measure ourselves against; those that are missing are left out of the table.
  find_package(meshoptimizer QUIET)
endif()
if(OCCLOD_BUILD_TESTS OR OCCLOD_BUILD_BENCH)
  find_package(embree REQUIRED)  # 3 or 4: rays that occlusion is judged by
endif()
if(OCCLOD_BUILD_TESTS)
  find_package(GTest REQUIRED)
  find_package(Python3 REQUIRED COMPONENTS Interpreter)
endif()
