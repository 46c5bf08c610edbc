// Makes occlusion backends by name.
#pragma once

#include <memory>
#include <string>

#include "json_output.h"
#include "occlod/visibility.h"

namespace occlod::tool {

struct BackendOptions {
  std::string occlusion = "software";  // none, software, gl-query; not auto
  std::string device = "gl";           // of gl-query: egl, osmesa; gl: what the machine offers
};

struct Backend {
  std::unique_ptr<Visibility> visibility;
  Json gl;  // platform, renderer, version, flight; null without GL
};

// Throws Error when this machine or build lacks the backend.
[[nodiscard]] Backend make_backend(const BackendOptions& options);

}  // namespace occlod::tool
