// The occlusion backends by name.
#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "json_output.h"
#include "occlod/refine/visibility.h"

namespace occlod::tool {

struct BackendOptions {
  std::string occlusion = "software";  // none, software, gl-query
  std::string gl_platform;             // egl, osmesa; empty = what the machine offers
  std::size_t flight = 8;              // queries under way at once, gl-query
};

struct Backend {
  std::unique_ptr<Visibility> visibility;
  Json gl;  // platform, renderer, version; null without GL
};

// Throws Error when this machine or build has no such backend.
[[nodiscard]] Backend make_backend(const BackendOptions& options);

}  // namespace occlod::tool
