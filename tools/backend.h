// The occlusion backends by name.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "json_output.h"
#include "occlod/visibility.h"

namespace occlod::tool {

// What is not given is left to the backend.
struct BackendOptions {
  std::string occlusion = "software";  // none, software, gl-query, gl-mark, gl-compute; not auto
  std::string gl_platform;             // egl, osmesa; empty = what the machine offers
  std::optional<std::size_t> flight;   // gl-*: questions under way at once
  std::optional<std::size_t> window;   // gl-query: of those, queries that OpenGL holds; 0 = measured
  std::optional<int> divisor;          // gl-query, gl-mark: one sample for so many pixels in each direction
  bool conservative = false;           // gl-query: GL_ANY_SAMPLES_PASSED_CONSERVATIVE
};

struct Backend {
  std::unique_ptr<Visibility> visibility;
  Json gl;  // platform, renderer, version, flight; null without GL
};

// Throws Error when this machine or build has no such backend, or the backend no such option.
[[nodiscard]] Backend make_backend(const BackendOptions& options);

}  // namespace occlod::tool
