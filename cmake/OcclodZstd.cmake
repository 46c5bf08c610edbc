# occlod::zstd, however the installed zstd calls its library: the names depend on its version and on how it was built. Also
# part of the installed package, since a static libocclod is linked where another zstd may be.
if(NOT TARGET occlod::zstd)
  add_library(occlod::zstd INTERFACE IMPORTED)
  foreach(occlod_zstd_name IN ITEMS zstd::libzstd zstd::libzstd_shared zstd::libzstd_static libzstd_static)
    if(TARGET ${occlod_zstd_name})
      target_link_libraries(occlod::zstd INTERFACE ${occlod_zstd_name})
      break()
    endif()
  endforeach()
endif()
