// HLODs at their places, and devices that draw them.
#pragma once

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "bindings.h"
#include "occlod/device.h"
#include "occlod/device_costs.h"
#include "occlod/item_buffer.h"

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

  // Whether meshes come and go. Whoever draws these keeps the GIL: one thread at a time may use their stores.
  [[nodiscard]] bool are_paged() const {
    return std::ranges::any_of(objects, [](const HlodObject& object) { return object.hlod.store() != nullptr; });
  }

  std::vector<HlodObject> objects;
  std::vector<hlod::PlacedHlod> placed;
};

// Of one HlodObject or Hlod, or a sequence of them. TypeError for anything else.
[[nodiscard]] std::vector<HlodObject> to_hlods(nb::handle objects);

struct PythonDevice {
  std::unique_ptr<hlod::RenderDevice> device;
  std::function<ItemBuffer()> picture;     // of the last frame
  std::optional<hlod::DeviceCosts> costs;  // measured when first needed
  std::shared_ptr<const KeptHlods> drawn;
  std::mutex in_use;

  // What its commands cost.
  [[nodiscard]] const hlod::DeviceCosts& needed_costs();
};

}  // namespace occlod::python
