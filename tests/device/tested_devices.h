// Devices that one suite runs on. Programs that link the suite say which by defining tested_devices().
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "occlod/device.h"

namespace occlod::hlod::test {

struct TestedDevice {
  std::string label;  // "virtual_modern"
  // Null, with the reason in `why`, where the machine has no such device.
  std::function<std::unique_ptr<RenderDevice>(std::string& why)> make;
  // More than one sample a pixel: counts are rounded up, and what shows at the centre of a pixel may be hidden at its
  // samples.
  bool multisampled = false;
};
inline std::ostream& operator<<(std::ostream& out, const TestedDevice& tested) { return out << tested.label; }

// Labels differ.
[[nodiscard]] std::vector<TestedDevice> tested_devices();

}  // namespace occlod::hlod::test
