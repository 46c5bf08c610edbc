// A shared library opened at run time, so that its absence is a message and not a failure to link or to start.
#pragma once

#include <initializer_list>
#include <string>

namespace occlod::gl {

class SharedLibrary {
 public:
  // Opens the first of `names` that is found. Throws Error with `remedy` when none is. Never closed again: drivers
  // leave thread-local destructors behind that point into themselves.
  SharedLibrary(std::initializer_list<const char*> names, const char* remedy);

  // Throws Error when the library has no such symbol.
  template <class Function>
  [[nodiscard]] Function symbol(const char* name) const {
    return reinterpret_cast<Function>(address(name));
  }

 private:
  [[nodiscard]] void* address(const char* name) const;

  void* handle_ = nullptr;
  std::string name_;
};

}  // namespace occlod::gl
