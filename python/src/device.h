// HLODs at their places, and devices that draw them.
#pragma once

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "bindings.h"
#include "occlod/device.h"
#include "occlod/device_costs.h"
#include "occlod/item_buffer.h"
#include "occlod/trial_devices.h"

namespace occlod::python {

struct HlodObject {
  hlod::Hlod hlod;
  glm::dmat4 object_to_world{1.0};
  bool two_sided = false;
  std::string source_name;  // for people; may be empty
};

// The HLODs of a traverser, which it points into; so does a device until its next frame.
struct KeptHlods {
  explicit KeptHlods(std::vector<HlodObject> given) : objects(std::move(given)) {
    for (const HlodObject& object : objects) placed.push_back({&object.hlod, object.object_to_world, object.two_sided});
  }
  KeptHlods(const KeptHlods&) = delete;
  KeptHlods& operator=(const KeptHlods&) = delete;

  std::vector<HlodObject> objects;
  std::vector<hlod::PlacedHlod> placed;
};

struct PythonDevice {
  std::unique_ptr<hlod::RenderDevice> device;
  std::function<ItemBuffer()> picture;              // of the last frame; none where nothing is drawn
  std::optional<hlod::DeviceCosts> costs;           // simulated, given, or measured when first needed
  std::unique_ptr<hlod::RecordingDevice> recorder;  // once start_recording() has been called
  std::shared_ptr<const KeptHlods> drawn;
  std::mutex in_use;

  // What frames are drawn with.
  [[nodiscard]] hlod::RenderDevice& active() const { return recorder ? *recorder : *device; }
  // What its commands cost. Throws Error for a recording that was given without.
  [[nodiscard]] const hlod::DeviceCosts& needed_costs();
};

}  // namespace occlod::python
