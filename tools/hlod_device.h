// Makes the devices that draw HLODs by name.
#pragma once

#include <memory>
#include <string>

#include "json_output.h"
#include "occlod/device.h"

namespace occlod::tool {

struct HlodDevice {
  std::string name;  // as on the command line
  std::unique_ptr<hlod::RenderDevice> device;
  Json gl;  // platform, renderer, version; null without OpenGL
};

// Makes software, gl, egl or osmesa. Throws Error for any other name, and when this machine or build has no such
// device.
[[nodiscard]] HlodDevice make_hlod_device(const std::string& name);

// This list is for help.
inline constexpr const char* hlod_device_names = "software, gl, egl or osmesa";

}  // namespace occlod::tool
