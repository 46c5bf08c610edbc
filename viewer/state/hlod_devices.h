// The devices that HLODs are drawn on, by name.
#pragma once

#include <array>
#include <functional>
#include <memory>

#include "occlod/device.h"
#include "settings.h"

namespace occlod::viewer {

// As on the command line; in the order of the enum.
inline constexpr std::array<const char*, 6> hlod_device_names = {
    "gl", "software", "virtual:query-cheap", "virtual:query-dear", "virtual:fill-bound", "virtual:modern"};
[[nodiscard]] inline const char* name_of(HlodDevice device) {
  return hlod_device_names[static_cast<std::size_t>(device)];
}
[[nodiscard]] inline bool is_virtual(HlodDevice device) { return device >= HlodDevice::query_cheap; }

// Makes a device, on the worker's thread. Throws Error when this machine has none such.
using MakeDevice = std::function<std::unique_ptr<hlod::RenderDevice>(HlodDevice)>;

// All but gl, for which it throws Error.
[[nodiscard]] std::unique_ptr<hlod::RenderDevice> make_portable_device(HlodDevice device);

}  // namespace occlod::viewer
