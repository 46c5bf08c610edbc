#include "gl/shared_library.h"

#include <dlfcn.h>

#include "occlod/core/error.h"

namespace occlod::gl {

SharedLibrary::SharedLibrary(std::initializer_list<const char*> names, const char* remedy) {
  for (const char* name : names) {
    handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    name_ = name;
    if (handle_ != nullptr) return;
  }
  // The last reason only: that of the plainest name.
  const char* reason = dlerror();
  throw Error({name_, "", reason != nullptr ? reason : "cannot be opened", remedy});
}

void* SharedLibrary::address(const char* name) const {
  void* found = dlsym(handle_, name);
  if (found == nullptr)
    throw Error({name_, "", std::string("has no function ") + name, "install a newer version of it"});
  return found;
}

}  // namespace occlod::gl
