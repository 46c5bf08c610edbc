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
#include <glm/mat4x4.hpp>
#include <new>
#include <span>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/bounds.h"
#include "occlod/mesh.h"
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

// Puts into numbers, from `first` on, what places a mesh: box, origin, 1 where y is up.
inline void tell_place(std::size_t first, const Box& box, const glm::dvec3& origin, UpAxis up) {
  numbers[first + 9] = up == UpAxis::y ? 1.0 : 0.0;
  for (int i = 0; i < 3; ++i) {
    const std::size_t at = first + static_cast<std::size_t>(i);
    numbers[at] = box.min[i];
    numbers[at + 3] = box.max[i];
    numbers[at + 6] = origin[i];
  }
}

// numbers: the transform of the coordinates of a mesh. Returns that of its positions.
inline glm::dmat4 transform_of_numbers(const glm::dvec3& origin) {
  return positions_to_world(glm::make_mat4(numbers.data()), origin);
}

}  // namespace occlod::web

extern "C" {

EMSCRIPTEN_KEEPALIVE inline const char* occlod_version() { return occlod::version(); }
EMSCRIPTEN_KEEPALIVE inline const char* occlod_failure() { return occlod::web::failure.c_str(); }
EMSCRIPTEN_KEEPALIVE inline double* occlod_numbers() { return occlod::web::numbers.data(); }

}  // extern "C"
