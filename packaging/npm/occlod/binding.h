// What the C interfaces have in common that JavaScript calls: of each module one. Objects are pointers, which
// occlod_free_...() takes back. A call that fails returns 0, and occlod_failure() its message; numbers of cameras and
// options pass through occlod_numbers(). Arrays that a call returns stay as they are until the next call.
#pragma once

#include <emscripten.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <glm/gtc/type_ptr.hpp>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/view.h"

namespace occlod::web {

struct Bytes {
  const void* data = nullptr;
  std::size_t size = 0;
};

inline std::string failure, text;
inline std::array<double, 40> numbers;
inline Bytes result;
inline std::vector<std::uint8_t> kept;  // what `result` may point to

// Returns call(), or nothing after an exception, which becomes `failure`.
template <typename Call>
auto guarded(const Call& call) -> decltype(call()) {
  failure.clear();
  try {
    return call();
  } catch (const std::bad_alloc&) {
    failure = "memory: not enough for this; dispose of what is no longer needed, or use a smaller mesh";
  } catch (const std::exception& error) {
    failure = error.what();
  }
  return {};
}

template <typename Element>
const Bytes* bytes_of(std::span<const Element> elements) {
  result = {elements.data(), elements.size_bytes()};
  return &result;
}

// numbers: 0, eye, target, up, field of view, width, height, near, far, orthographic height or NaN;
// or 1, world to eye, eye to clip, width, height, ClipDepth.
inline View view_of_numbers() {
  const double* n = numbers.data();
  if (n[0] != 0.0)
    return view_of(glm::make_mat4(n + 1), glm::make_mat4(n + 17), static_cast<int>(n[33]), static_cast<int>(n[34]),
                   static_cast<ClipDepth>(static_cast<int>(n[35])));
  Camera camera;
  camera.eye = glm::make_vec3(n + 1);
  camera.target = glm::make_vec3(n + 4);
  camera.up = glm::make_vec3(n + 7);
  camera.fov_y_deg = n[10];
  camera.width = static_cast<int>(n[11]);
  camera.height = static_cast<int>(n[12]);
  camera.near = n[13];
  camera.far = n[14];
  if (!std::isnan(n[15])) camera.orthographic_height = n[15];
  return View(camera);
}

}  // namespace occlod::web

extern "C" {

EMSCRIPTEN_KEEPALIVE inline const char* occlod_version() { return occlod::version(); }
EMSCRIPTEN_KEEPALIVE inline const char* occlod_failure() { return occlod::web::failure.c_str(); }
EMSCRIPTEN_KEEPALIVE inline double* occlod_numbers() { return occlod::web::numbers.data(); }

}  // extern "C"
