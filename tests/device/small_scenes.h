// Small HLODs, and views of them.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

#include "occlod/device.h"
#include "occlod/hlod.h"
#include "occlod/view.h"

namespace occlod::hlod::test {

// 64 x 48 pixels; the eye at (0, 0, 3) looks along -z, 45 degrees up and down.
[[nodiscard]] Camera small_camera();
// Its pixels in the plane z = 0: 3 * 2 tan(22.5 degrees) / 48.
inline constexpr double pixel_at_wall = 0.05177669529663688;

// [-1, 1]^2 in the plane z = 0, 128 triangles in one node.
[[nodiscard]] const Hlod& wall();
// A rough planet of 8,192 triangles, in nodes of 128, on several levels.
[[nodiscard]] const Hlod& planet();

// Draws the whole node, without morphing.
void draw_node(RenderDevice& device, std::uint32_t object, const Hlod& hlod, NodeId node);
// Draws all nodes of level 0.
void draw_finest(RenderDevice& device, std::uint32_t object, const Hlod& hlod);

// The answer to one box, waited for.
[[nodiscard]] std::uint32_t count_of(RenderDevice& device, const BoxRef& box);
// A cube around a point.
[[nodiscard]] Box cube(const glm::vec3& center, float half);

}  // namespace occlod::hlod::test
