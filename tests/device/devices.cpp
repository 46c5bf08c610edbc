#include "device/tested_devices.h"
#include "occlod/device.h"
#include "papers/trial_devices.h"

namespace occlod::hlod::test {

std::vector<TestedDevice> tested_devices() {
  DeviceCosts late = device_preset("query-dear");
  late.latency_commands = 5;
  return {
      {"software", [](std::string&) { return std::make_unique<SoftwareDevice>(); }},
      {"software_items", [](std::string&) { return std::make_unique<SoftwareDevice>(true); }},
      {"virtual_modern", [](std::string&) { return std::make_unique<VirtualDevice>(device_preset("modern")); }},
      {"virtual_late", [late](std::string&) { return std::make_unique<VirtualDevice>(late); }},
  };
}

}  // namespace occlod::hlod::test
