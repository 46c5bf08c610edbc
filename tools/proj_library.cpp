#include "proj_library.h"

#include "base/shared_library.h"

namespace occlod::tool {
namespace {

ProjLibrary open_proj() {
  // All of PROJ 9 has been number 25; the last name is there with the headers.
  const SharedLibrary library({"libproj.so.25", "libproj.25.dylib", "libproj.so"},
                              "install PROJ 9.1 or later (Debian, Ubuntu: libproj25), which --crs needs");
  ProjLibrary functions{};
#define OCCLOD_PROJ_FUNCTION(name) functions.name = library.symbol<decltype(functions.name)>("proj_" #name);
  OCCLOD_PROJ_FUNCTIONS(OCCLOD_PROJ_FUNCTION)
#undef OCCLOD_PROJ_FUNCTION
  return functions;
}

}  // namespace

const ProjLibrary& proj() {
  static const ProjLibrary library = open_proj();
  return library;
}

}  // namespace occlod::tool
