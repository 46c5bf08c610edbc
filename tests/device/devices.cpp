#include "device/tested_devices.h"
#include "occlod/device/software_device.h"

namespace occlod::hlod::test {

std::vector<TestedDevice> tested_devices() {
  return {
      {"software", [](std::string&) { return std::make_unique<SoftwareDevice>(); }},
      {"software_items", [](std::string&) { return std::make_unique<SoftwareDevice>(SoftwareDeviceOptions{true}); }},
  };
}

}  // namespace occlod::hlod::test
