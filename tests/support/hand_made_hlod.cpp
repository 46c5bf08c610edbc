#include "support/hand_made_hlod.h"

#include <algorithm>
#include <cstring>
#include <glm/geometric.hpp>
#include <utility>

#include "base/arithmetic.h"
#include "hlod/store/hlod_data.h"
#include "support/cameras.h"

namespace occlod::test {
namespace {

using hlod::HlodData;
using hlod::Node;
using hlod::NodeId;
using hlod::stays;

// One panel on one level: a vertex of the level below is merged into the one before it, or stays.
struct PanelMesh {
  std::vector<glm::vec3> positions;
  std::vector<std::uint16_t> indices;
  std::vector<std::uint16_t> merged_into;  // of the next level
};

// Corners 0 to 3 counter-clockwise, from level 1 on; on level 0 also 4 and 5 in the middle of the lower and upper side.
PanelMesh panel_mesh(const Panel& panel, std::size_t level) {
  const glm::vec3 x(panel.size.x, 0.0F, 0.0F), y(0.0F, panel.size.y, 0.0F);
  const glm::vec3 o = panel.min;
  if (level == 0)
    return {{o, o + x, o + x + y, o + y, o + 0.5F * x, o + 0.5F * x + y},
            {0, 4, 5, 0, 5, 3, 4, 1, 2, 4, 2, 5},
            {0, 1, 2, 3, 0, 3}};
  if (level == 1) return {{o, o + x, o + x + y, o + y}, {0, 1, 2, 0, 2, 3}, {0, 1, 2, 2}};
  return {{o, o + x, o + x + y}, {0, 1, 2}, {0, 1, 2}};
}

class Maker {
 public:
  Maker(std::span<const Panel> panels, std::span<const float> errors)
      : panels_(panels), errors_(errors), members_(errors.size()) {
    data_.nodes.resize(errors.size());
  }

  hlod::Hlod make() {
    const std::size_t levels = panels_[0].nodes.size();
    data_.levels.resize(levels);
    first_vertex_.assign(levels, std::vector<std::size_t>(panels_.size()));
    for (std::size_t level = 0; level < levels; ++level) number_level(level);
    for (NodeId n = 0; n < data_.nodes.size(); ++n) add_mesh(n);  // parents first: children name their vertices
    for (NodeId n = static_cast<NodeId>(data_.nodes.size()); n-- > 0;) bound(n);
    for (NodeId n = 0; n < data_.nodes.size(); ++n) add_children(n);
    data_.box = data_.nodes[0].lod_box;
    data_.node_triangles = 16;
    return make_hlod(std::move(data_));
  }

 private:
  void number_level(std::size_t level) {
    NodeId first = no_id, last = 0;
    for (std::size_t i = 0; i < panels_.size(); ++i) {
      const NodeId n = panels_[i].nodes[level];
      members_[n].push_back(i);
      data_.nodes[n].level = static_cast<std::uint16_t>(level);
      first = std::min(first, n);
      last = std::max(last, n);
    }
    data_.levels[level] = {first, last - first + 1};
    if (level + 1 == data_.levels.size())
      for (NodeId n = first; n <= last; ++n) data_.roots.push_back(n);
  }

  [[nodiscard]] NodeId parent_of(std::size_t panel, std::size_t level) const {
    return level + 1 < panels_[panel].nodes.size() ? panels_[panel].nodes[level + 1] : no_id;
  }

  void add_mesh(NodeId n) {
    Node& node = data_.nodes[n];
    const std::size_t level = node.level;
    std::stable_sort(members_[n].begin(), members_[n].end(),
                     [&](std::size_t a, std::size_t b) { return parent_of(a, level) < parent_of(b, level); });
    node.first_patch = static_cast<std::uint32_t>(data_.patches.size());
    PanelMesh all;
    for (const std::size_t panel : members_[n]) add_panel(panel, node, all);
    node.triangles = static_cast<std::uint32_t>(all.indices.size() / 3);
    node.vertices = static_cast<std::uint32_t>(all.positions.size());
    if (level == 0) data_.input_triangle_count += node.triangles;
    store(node, all);
  }

  void add_panel(std::size_t panel, Node& node, PanelMesh& all) {
    const NodeId parent = parent_of(panel, node.level);
    if (node.patches == 0 || data_.patches.back().parent != parent) {
      data_.patches.push_back({parent, static_cast<std::uint32_t>(all.indices.size()), 0});
      ++node.patches;
    }
    const PanelMesh part = panel_mesh(panels_[panel], node.level);
    data_.patches.back().index_count += static_cast<std::uint32_t>(part.indices.size());
    const std::size_t first = all.positions.size();
    first_vertex_[node.level][panel] = first;
    for (std::size_t v = 0; v < part.positions.size(); ++v) {
      const bool moves = parent != no_id && part.merged_into[v] != v;
      all.merged_into.push_back(
          moves ? static_cast<std::uint16_t>(first_vertex_[node.level + 1U][panel] + part.merged_into[v]) : stays);
    }
    for (const std::uint16_t index : part.indices) all.indices.push_back(static_cast<std::uint16_t>(first + index));
    all.positions.insert(all.positions.end(), part.positions.begin(), part.positions.end());
  }

  void store(Node& node, const PanelMesh& mesh) {
    const hlod::MeshLayout layout(node, {});
    node.mesh = data_.meshes.size();
    data_.meshes.resize(
        node.mesh + (layout.bytes + hlod::mesh_alignment - 1) / hlod::mesh_alignment * hlod::mesh_alignment,
        std::byte{0});
    std::byte* const bytes = data_.meshes.data() + node.mesh;
    const auto copy = [&](std::size_t offset, const auto& values) {
      std::memcpy(bytes + offset, values.data(), values.size() * sizeof(values[0]));
    };
    copy(0, mesh.positions);
    copy(layout.indices, mesh.indices);
    copy(layout.merged_into, mesh.merged_into);
  }

  // Children first.
  void bound(NodeId n) {
    Node& node = data_.nodes[n];
    std::vector<glm::vec3> corners;
    for (const std::size_t i : members_[n]) {
      corners.push_back(panels_[i].min);
      corners.push_back(panels_[i].min + glm::vec3(panels_[i].size, 0.0F));
      node.area += panels_[i].size.x * panels_[i].size.y * (node.level < 2 ? 1.0F : 0.5F);
    }
    node.box = bounding_box(corners);
    node.box.min.z -= 0.001F * static_cast<float>(node.level);  // so that a box tells which node it is of
    node.lod_box = node.box;
    node.error = node.guaranteed_error = errors_[n];
    for (const NodeId child : children_of(n)) {
      node.lod_box = unite(node.lod_box, data_.nodes[child].lod_box);
      node.child_error = std::max(node.child_error, data_.nodes[child].error);
    }
    node.sphere.center = 0.5F * (node.lod_box.min + node.lod_box.max);
    node.sphere.radius = 1.001F * glm::distance(node.sphere.center, node.lod_box.max);
    for (const NodeId child : children_of(n)) {
      const Sphere& sphere = data_.nodes[child].sphere;
      const float reach = glm::distance(sphere.center, node.sphere.center) + sphere.radius;
      node.sphere.radius = std::max(node.sphere.radius, 1.001F * reach);
    }
  }

  [[nodiscard]] std::vector<NodeId> children_of(NodeId n) const {
    std::vector<NodeId> children;
    if (data_.nodes[n].level > 0)
      for (const std::size_t i : members_[n]) children.push_back(panels_[i].nodes[data_.nodes[n].level - 1U]);
    std::sort(children.begin(), children.end());
    children.erase(std::unique(children.begin(), children.end()), children.end());
    return children;
  }

  void add_children(NodeId n) {
    const std::vector<NodeId> children = children_of(n);
    data_.nodes[n].first_child = static_cast<std::uint32_t>(data_.children.size());
    data_.nodes[n].children = static_cast<std::uint16_t>(children.size());
    data_.children.insert(data_.children.end(), children.begin(), children.end());
  }

  std::span<const Panel> panels_;
  std::span<const float> errors_;
  std::vector<std::vector<std::size_t>> members_;       // by node: its panels, by parent
  std::vector<std::vector<std::size_t>> first_vertex_;  // by level and panel, in the mesh of the node
  HlodData data_;
};

}  // namespace

hlod::Hlod hand_made_hlod(std::span<const Panel> panels, std::span<const float> errors) {
  return Maker(panels, errors).make();
}

// The first row leaves no gap: its panels overlap, one a little behind the other.
hlod::Hlod two_rows(bool last_rises) {
  const std::vector<Panel> panels = {{{-3.0F, -1.0F, 0.0F}, {2.1F, 2.0F}, {3, 1, 0}},
                                     {{-1.0F, -1.0F, -0.01F}, {2.1F, 2.0F}, {4, 1, 0}},
                                     {{1.0F, -1.0F, -0.02F}, {2.1F, 2.0F}, {5, 1, 0}},
                                     {{-2.6F, -0.6F, -4.0F}, {1.2F, 1.2F}, {6, 2, 0}},
                                     {{-0.6F, -0.6F, -4.0F}, {1.2F, 1.2F}, {7, 2, 0}},
                                     {{1.4F, -0.6F, -4.0F}, {1.2F, last_rises ? 4.0F : 1.2F}, {8, 2, 0}}};
  return hand_made_hlod(panels, std::vector<float>{2.0F, 1.0F, 1.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F});
}

Camera square_camera(const glm::dvec3& eye, const glm::dvec3& target) {
  Camera camera = origin_camera(100, 100);
  camera.eye = eye;
  camera.target = target;
  camera.near = 0.1;
  return camera;
}

Camera camera_ahead() { return square_camera({-2.0, 0.0, 10.0}, {-2.0, 0.0, 0.0}); }

hlod::Hlod shared_child() {
  const std::vector<Panel> panels = {{{-3.0F, -1.0F, 0.0F}, {1.9F, 2.0F}, {6, 3, 1, 0}},
                                     {{-1.0F, -1.0F, 0.0F}, {0.9F, 2.0F}, {7, 4, 1, 0}},
                                     {{0.0F, -1.0F, 0.0F}, {0.9F, 2.0F}, {7, 4, 2, 0}},
                                     {{1.0F, -1.0F, 0.0F}, {1.9F, 2.0F}, {8, 5, 2, 0}}};
  return hand_made_hlod(panels, std::vector<float>{3.0F, 2.0F, 2.0F, 1.0F, 1.0F, 1.0F, 0.0F, 0.0F, 0.0F});
}

hlod::Hlod shared_grandchild() {
  const std::vector<Panel> panels = {{{-3.0F, -1.0F, 0.0F}, {1.9F, 2.0F}, {7, 5, 3, 1, 0}},
                                     {{-1.0F, -1.0F, 0.0F}, {0.9F, 2.0F}, {7, 5, 4, 2, 0}},
                                     {{0.0F, -1.0F, 0.0F}, {1.9F, 2.0F}, {8, 6, 4, 2, 0}}};
  return hand_made_hlod(panels, std::vector<float>{4.0F, 3.0F, 3.0F, 2.0F, 2.0F, 1.0F, 1.0F, 0.0F, 0.0F});
}

hlod::Hlod one_panel(const glm::vec3& min, const glm::vec2& size) {
  const std::vector<Panel> panels = {{min, size, {0}}};
  return hand_made_hlod(panels, std::vector<float>{0.0F});
}

}  // namespace occlod::test
