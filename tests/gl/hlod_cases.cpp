#include "gl/hlod_cases.h"

#include <array>

#include "hlod/store/hlod_data.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/compare.h"
#include "support/meshes.h"

namespace occlod::gl {
namespace {

hlod::DrawRange whole(const hlod::Node& node, float morph) { return {0, 3 * node.triangles, morph}; }

}  // namespace

void EachHlodDevice::SetUp() {
  std::string why;
  context_ = context_or_null(GetParam().platform, why);
  if (!context_) GTEST_SKIP() << "no context: " << why;
}

std::vector<TestedDevice> tested_devices() {
  return {{Platform::egl, false}, {Platform::egl, true}, {Platform::osmesa, false}, {Platform::osmesa, true}};
}

const hlod::Hlod& sphere_hlod() {
  static const hlod::Hlod hlod = [] {
    hlod::HlodBuildOptions options;
    options.node_triangles = 64;
    return hlod::build_hlod(test::noisy_sphere(5, 1), options);
  }();
  return hlod;
}

hlod::Hlod hlod_of(const Soup& soup) {
  TriangleMesh mesh;
  mesh.positions = soup.positions;
  mesh.triangles = soup.triangles;
  return hlod::build_hlod(mesh);
}

View sphere_view() {
  Camera camera;
  camera.width = 320;
  camera.height = 240;
  camera.eye = {0.3, 0.5, 3.2};
  camera.near = 0.1;
  camera.far = 50.0;
  return View(camera);
}

void draw_node(HlodDevice& device, std::uint32_t object, const hlod::Hlod& hlod, hlod::NodeId node, float morph) {
  if (hlod.node(node).triangles == 0) return;
  const std::array<hlod::DrawRange, 1> ranges{whole(hlod.node(node), morph)};
  device.draw({object, node, ranges});
}

void draw_level(HlodDevice& device, const hlod::Hlod& hlod, std::uint32_t level, float morph, std::uint32_t object) {
  const hlod::Level& nodes = hlod.data().levels[level];
  for (hlod::NodeId n = nodes.first_node; n < nodes.first_node + nodes.node_count; ++n)
    draw_node(device, object, hlod, n, morph);
}

TriangleMesh level_mesh(const hlod::Hlod& hlod, std::uint32_t level, float morph) {
  TriangleMesh result;
  const hlod::Level& nodes = hlod.data().levels[level];
  for (hlod::NodeId n = nodes.first_node; n < nodes.first_node + nodes.node_count; ++n) {
    const hlod::NodeMesh mesh = hlod.mesh(n);
    const auto first = static_cast<VertexId>(result.positions.size());
    result.positions.insert(result.positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const hlod::Patch& patch : hlod.patches(n))
      for (std::uint32_t i = patch.first_index; i < patch.first_index + patch.index_count; ++i) {
        const std::uint16_t v = mesh.indices[i];
        if (i % 3 == 0) result.triangles.emplace_back();
        result.triangles.back()[static_cast<int>(i % 3)] = first + v;
        if (patch.parent == no_id || mesh.merged_into[v] == hlod::stays) continue;
        const glm::vec3 merged = hlod.mesh(patch.parent).positions[mesh.merged_into[v]];
        result.positions[first + v] = mesh.positions[v] * (1.0F - morph) + merged * morph;
      }
  }
  return result;
}

ItemBuffer items_of(const TriangleMesh& mesh, const View& view, const glm::dmat4& object_to_world) {
  ItemBuffer items;
  const std::array<DrawObject, 1> objects{{{mesh.positions, {}, mesh.triangles, object_to_world}}};
  draw_items(items, objects, view);
  return items;
}

std::size_t different_pixels(const View& view, const DepthBuffer& one, const DepthBuffer& other) {
  return count_unexplained_pixels(view, one, other, 1.0) + count_unexplained_pixels(view, other, one, 1.0);
}

}  // namespace occlod::gl
