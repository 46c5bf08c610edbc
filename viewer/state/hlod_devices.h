// Names and makes the devices that draw HLODs.
#pragma once

#include <array>
#include <functional>
#include <memory>

#include "occlod/device.h"
#include "settings.h"

namespace occlod::viewer {

// These are the names on the command line, in the order of the enum.
inline constexpr std::array<const char*, 2> hlod_device_names = {"gl", "software"};
[[nodiscard]] inline const char* name_of(HlodDevice device) {
  return hlod_device_names[static_cast<std::size_t>(device)];
}

// Makes a device on the worker's thread. Throws Error when this machine lacks it.
using MakeDevice = std::function<std::unique_ptr<hlod::RenderDevice>(HlodDevice)>;

// Makes any device but gl, for which it throws Error.
[[nodiscard]] std::unique_ptr<hlod::RenderDevice> make_portable_device(HlodDevice device);

}  // namespace occlod::viewer
