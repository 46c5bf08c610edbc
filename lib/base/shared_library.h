// Opens a shared library at run time, so that its absence causes an error message instead of a failure to link or to
// start.
#pragma once

#include <dlfcn.h>

#include <initializer_list>
#include <string>

#include "occlod/base.h"

namespace occlod {

// The program that opens one links ${CMAKE_DL_LIBS}.
class SharedLibrary {
 public:
  // Opens the first of `names` that is found. Throws Error with `remedy` when none is. Never closes the library:
  // drivers leave thread-local destructors behind that point into it.
  SharedLibrary(std::initializer_list<const char*> names, const char* remedy) {
    for (const char* name : names) {
      handle_ = dlopen(name, RTLD_NOW | RTLD_LOCAL);
      name_ = name;
      if (handle_ != nullptr) return;
    }
    // The last reason only: that of the plainest name.
    const char* reason = dlerror();
    throw Error({name_, "", reason != nullptr ? reason : "cannot be opened", remedy});
  }

  // Returns the symbol. Throws Error when the library does not have it.
  template <class Function>
  [[nodiscard]] Function symbol(const char* name) const {
    return reinterpret_cast<Function>(address(name));
  }

 private:
  [[nodiscard]] void* address(const char* name) const {
    void* found = dlsym(handle_, name);
    if (found == nullptr)
      throw Error({name_, "", std::string("has no function ") + name, "install a newer version of it"});
    return found;
  }

  void* handle_ = nullptr;
  std::string name_;
};

}  // namespace occlod
