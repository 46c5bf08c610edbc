// The device `gl` on every platform and with both settings, and HLODs to draw with it.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <ostream>
#include <span>
#include <string>
#include <vector>

#include "gl/support.h"
#include "occlod/gl.h"
#include "occlod/hlod.h"
#include "occlod/item_buffer.h"
#include "occlod/picture.h"

namespace occlod::gl {

struct TestedDevice {
  Platform platform = Platform::egl;
  bool quality = false;

  [[nodiscard]] std::string label() const { return platform_label(platform) + (quality ? "_quality" : ""); }
};
inline std::ostream& operator<<(std::ostream& out, const TestedDevice& tested) { return out << tested.label(); }

// A suite's base: one context a test, skipped where the machine has none.
class EachHlodDevice : public testing::TestWithParam<TestedDevice> {
 protected:
  void SetUp() override;
  [[nodiscard]] std::unique_ptr<HlodDevice> make(std::size_t mesh_bytes = HlodDeviceOptions{}.mesh_bytes) const {
    return make_hlod_device(context_, {GetParam().quality, mesh_bytes});
  }

  View view_ = test_view();
  std::shared_ptr<Context> context_;
};

[[nodiscard]] std::vector<TestedDevice> tested_devices();
inline const auto device_label = [](const auto& param) { return param.param.label(); };

// A noisy sphere of radius 1 around the origin in nodes of some 64 triangles; 16,384 in all.
[[nodiscard]] const hlod::Hlod& sphere_hlod();
// One node with these triangles.
[[nodiscard]] hlod::Hlod hlod_of(const Soup& soup);
// 320 x 240 pixels; the unit sphere fills most of the height.
[[nodiscard]] View sphere_view();

// All that a level has, drawn node by node. The factor is that of all its vertices.
void draw_level(HlodDevice& device, const hlod::Hlod& hlod, std::uint32_t level, float morph = 0.0F,
                std::uint32_t object = 0);
// A whole node.
void draw_node(HlodDevice& device, std::uint32_t object, const hlod::Hlod& hlod, hlod::NodeId node, float morph = 0.0F);

// The same triangles for the CPU: each node's vertices, where they have slid to.
[[nodiscard]] TriangleMesh level_mesh(const hlod::Hlod& hlod, std::uint32_t level, float morph = 0.0F);
[[nodiscard]] ItemBuffer items_of(const TriangleMesh& mesh, const View& view,
                                  const glm::dmat4& object_to_world = glm::dmat4(1.0));

// Pixels of either image that the other cannot explain by moving anything by a pixel: rasterisers decide differently at
// edges, and one of several samples of a pixel is beside its centre.
[[nodiscard]] std::size_t different_pixels(const View& view, const DepthBuffer& one, const DepthBuffer& other);

}  // namespace occlod::gl
