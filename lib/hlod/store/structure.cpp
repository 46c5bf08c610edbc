#include "hlod/store/structure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "hlod/build/within_points.h"
#include "hlod/store/hlod_data.h"
#include "occlod/hlod.h"

namespace occlod::hlod {
namespace {

// Returns a number in [0, 1) that is the same with every standard library.
double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11U) * 0x1p-53; }

bool are_parents_refined(const Hlod& hlod, const Refined& refined, NodeId n) {
  return std::ranges::all_of(hlod.patches(n),
                             [&](const Patch& patch) { return patch.parent == no_id || refined[patch.parent] != 0; });
}

}  // namespace

Refined random_front(const Hlod& hlod, std::mt19937_64& random) {
  const double probability = 0.3 + 0.7 * uniform(random);
  const bool is_local = random() % 2 == 0;
  const Box& box = hlod.data().box;
  const glm::dvec3 size = glm::dvec3(box.max) - glm::dvec3(box.min);
  const glm::dvec3 middle(hlod.node(static_cast<NodeId>(random() % hlod.node_count())).sphere.center);
  const double reach = glm::length(size) * 0.5 * uniform(random);
  const auto wanted = [&](const Node& node) {
    if (!is_local) return probability;
    const double distance = glm::distance(glm::dvec3(node.sphere.center), middle);
    return distance < reach + static_cast<double>(node.sphere.radius) ? 0.97 : 0.03;
  };
  Refined refined(hlod.node_count(), 0);
  for (NodeId n = 0; n < hlod.node_count(); ++n) {  // parents first
    if (hlod.node(n).level == 0) continue;
    const bool may_be = are_parents_refined(hlod, refined, n);
    refined[n] = uniform(random) < wanted(hlod.node(n)) && may_be ? 1 : 0;
  }
  return refined;
}

Cuts random_cuts_of(const Hlod& hlod, const Refined& refined, std::mt19937_64& random) {
  Cuts cuts(hlod.node_count(), 0);
  for (NodeId n = 0; n < hlod.node_count(); ++n)
    if (hlod.has_within(n) && refined[n] == 0 && are_parents_refined(hlod, refined, n) && random() % 2 == 0)
      cuts[n] = whole_splits(hlod, n, static_cast<std::uint32_t>(random() % (hlod.data().within[n].splits + 1U)));
  return cuts;
}

namespace {

using Problem = std::optional<std::string>;

bool is_finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool is_box(const Box& b) {
  return is_finite(b.min) && is_finite(b.max) && b.min.x <= b.max.x && b.min.y <= b.max.y && b.min.z <= b.max.z;
}
bool is_length(float x) { return std::isfinite(x) && x >= 0.0F; }

bool are_materials(const HlodView& data, std::span<const MaterialId> ids) {
  return std::ranges::all_of(ids, [&](MaterialId m) { return m < data.materials.size(); });
}

bool is_of_one_material(std::span<const MaterialId> materials, std::uint16_t a, std::uint16_t b, std::uint16_t c) {
  return materials.empty() || (materials[a] == materials[b] && materials[b] == materials[c]);
}

class StructureCheck {
 public:
  StructureCheck(const HlodView& data, std::uint64_t mesh_bytes) : d_(data), mesh_bytes_(mesh_bytes) {}

  Problem run() {
    if (const Problem problem = check_levels()) return problem;
    if (!is_length(d_.lattice_step)) return "the step of its lattice is no length";
    if (const Problem problem = check_materials()) return problem;
    std::uint64_t input_triangles = 0, links = 0;
    for (NodeId n = 0; n < d_.nodes.size(); ++n) {
      if (const Problem problem = check_node(n)) return fmt::format("node {} {}", n, *problem);
      if (d_.nodes[n].level == 0) input_triangles += d_.nodes[n].triangles;
      if (!is_root(d_.nodes[n])) links += d_.nodes[n].patches;
    }
    for (NodeId n = 0; n < d_.nodes.size(); ++n)
      if (const Problem problem = check_children(n)) return fmt::format("node {} {}", n, *problem);
    if (next_patch_ != d_.patches.size()) return "there are patches of no node";
    if (next_child_ != d_.children.size() || next_child_ != links) return "children and parents contradict each other";
    if (const Problem problem = check_splits()) return problem;
    if (input_triangles != d_.input_triangle_count)
      return fmt::format("level 0 has {} triangles, not {}", input_triangles, d_.input_triangle_count);
    if (const Problem problem = check_features(d_)) return problem;
    return check_roots();
  }

 private:
  [[nodiscard]] bool is_root(const Node& node) const {
    return node.patches == 0 || d_.patches[node.first_patch].parent == no_id;
  }

  [[nodiscard]] Problem check_levels() const {
    if (d_.nodes.empty() || d_.levels.empty()) return "there are no nodes";
    if (d_.grouping > Grouping::shifted || d_.borders > Borders::locked) return "the grouping or borders are unknown";
    if (!is_box(d_.box)) return "the box is none";
    std::uint64_t next = 0;
    for (std::size_t level = d_.levels.size(); level-- > 0;) {
      if (d_.levels[level].first_node != next || d_.levels[level].node_count == 0)
        return fmt::format("level {} does not begin where the one above it ends", level);
      next += d_.levels[level].node_count;
    }
    return next == d_.nodes.size() ? Problem() : "the levels are not all nodes";
  }

  [[nodiscard]] Problem check_materials() const {
    if (d_.has_materials && d_.materials.empty()) return "there are no materials, but vertices name some";
    for (std::size_t m = 0; m < d_.materials.size(); ++m)
      if (d_.materials[m].texture_beyond(d_.textures.size()) != no_texture)
        return fmt::format("material {} has a texture that is not there", m);
    if (!d_.node_images.empty() &&
        (d_.node_images.size() != d_.nodes.size() || d_.image_materials.size() != d_.materials.size()))
      return "images of nodes do not tell of all nodes and materials";
    return {};
  }

  [[nodiscard]] bool is_in_level(NodeId n, std::size_t level) const {
    return level < d_.levels.size() && n >= d_.levels[level].first_node &&
           n - d_.levels[level].first_node < d_.levels[level].node_count;
  }

  Problem check_node(NodeId n) {
    const Node& node = d_.nodes[n];
    if (!is_in_level(n, node.level)) return "is not in its level";
    if (!is_box(node.box) || !is_box(node.lod_box)) return "has a box that is none";
    if (!is_finite(node.sphere.center) || !is_length(node.sphere.radius)) return "has a sphere that is none";
    if (!is_length(node.error) || !is_length(node.child_error) || !is_length(node.guaranteed_error) ||
        !is_length(node.area))
      return "has an error or area that is none";
    if (node.vertices > stays || 3 * std::uint64_t{node.triangles} > 0xffffffffU) return "is too large";
    if (node.mesh % mesh_alignment != 0 || node.mesh > mesh_bytes_ ||
        MeshLayout(node, arrays_of(d_)).bytes > mesh_bytes_ - node.mesh)
      return "has a mesh outside the meshes";
    if (!d_.node_images.empty() && !is_image(d_.node_images[n], node)) return "has an image outside the images";
    return check_patches(node);
  }

  // Images of an HLOD with a store lie elsewhere, where reading checks their places.
  [[nodiscard]] bool is_image(const NodeImage& image, const Node& node) const {
    if (image.bytes == 0) return true;
    const bool is_within =
        d_.images.empty() || (image.place <= d_.images.size() && image.bytes <= d_.images.size() - image.place);
    return is_within && image.place % mesh_alignment == 0 && image.bytes > node.vertices * sizeof(glm::u16vec2) &&
           is_length(image.texel_size);
  }

  Problem check_patches(const Node& node) {
    if (node.first_patch != next_patch_ || node.patches > d_.patches.size() - next_patch_)
      return "has patches that do not follow those before it";
    next_patch_ += node.patches;
    std::uint64_t next_index = 0;
    const auto patches = d_.patches.subspan(node.first_patch, node.patches);
    for (std::size_t i = 0; i < patches.size(); ++i) {
      const Patch& patch = patches[i];
      if (patch.first_index != next_index || patch.index_count == 0 || patch.index_count % 3 != 0)
        return "has patches that do not divide its triangles";
      next_index += patch.index_count;
      if (patch.parent == no_id ? patches.size() > 1 : !is_in_level(patch.parent, node.level + std::size_t{1}))
        return "has a parent that is not one level up";
      if (i > 0 && patch.parent <= patches[i - 1].parent) return "has patches that are not sorted by parent";
    }
    return next_index == 3 * std::uint64_t{node.triangles} ? Problem() : "has triangles in no patch";
  }

  Problem check_children(NodeId n) {
    const Node& node = d_.nodes[n];
    if (node.first_child != next_child_ || node.children > d_.children.size() - next_child_)
      return "has children that do not follow those before it";
    next_child_ += node.children;
    if ((node.children == 0) != (node.level == 0)) return "has children on level 0, or none above it";
    const auto children = d_.children.subspan(node.first_child, node.children);
    for (std::size_t i = 0; i < children.size(); ++i) {
      if (!is_in_level(children[i], node.level - std::size_t{1})) return "has a child that is not one level down";
      if (i > 0 && children[i] <= children[i - 1]) return "has children that are not ascending";
      if (!names(d_.nodes[children[i]], n)) return fmt::format("has the child {}, which does not name it", children[i]);
    }
    return {};
  }

  [[nodiscard]] bool names(const Node& child, NodeId parent) const {
    const auto patches = d_.patches.subspan(child.first_patch, child.patches);
    return std::any_of(patches.begin(), patches.end(), [&](const Patch& patch) { return patch.parent == parent; });
  }

  [[nodiscard]] Problem check_splits() const {
    if (d_.within.empty()) return d_.splits.empty() ? Problem() : "there are splits of no node";
    if (d_.within.size() != d_.nodes.size()) return "there are splits of some nodes only";
    for (NodeId n = 0; n < d_.nodes.size(); ++n)
      if (const Problem problem = check_splits(d_.nodes[n], d_.within[n]))
        return fmt::format("node {} {}", n, *problem);
    return {};
  }

  [[nodiscard]] Problem check_splits(const Node& node, const NodeWithin& within) const {
    if (within.place > d_.splits.size()) return "has splits outside the splits";
    if (within.splits == 0)
      return within.bare == 0 && within.triangles == 0 ? Problem() : "has what splits need, but no splits";
    if (node.level == 0) return "is part of the input, but has splits";
    if (std::uint64_t{node.vertices} + within.bare + within.splits > stays ||
        3 * std::uint64_t{within.triangles} > 0xffffffffU)
      return "has too many splits";
    if (within.place % mesh_alignment != 0 ||
        SplitsLayout(within, arrays_of(d_)).bytes > d_.splits.size() - within.place)
      return "has splits outside the splits";
    return {};
  }

  [[nodiscard]] Problem check_roots() const {
    std::size_t next = 0;
    for (NodeId n = 0; n < d_.nodes.size(); ++n)
      if (is_root(d_.nodes[n]) && (next == d_.roots.size() || d_.roots[next++] != n))
        return fmt::format("node {} is not among the roots", n);
    return next == d_.roots.size() ? Problem() : "there are roots that have parents";
  }

  const HlodView& d_;
  std::uint64_t mesh_bytes_;
  std::size_t next_patch_ = 0, next_child_ = 0;
};

}  // namespace

std::optional<std::string> check_structure(const HlodView& data) { return check_structure(data, data.meshes.size()); }

std::optional<std::string> check_structure(const HlodView& data, std::uint64_t mesh_bytes) {
  return StructureCheck(data, mesh_bytes).run();
}

std::optional<std::string> check_mesh(const HlodView& data, NodeId n) {
  return check_mesh(data, n, Hlod(data, nullptr).mesh(n));
}

std::optional<std::string> check_mesh(const HlodView& data, NodeId n, const NodeMesh& mesh) {
  const Hlod hlod(data, nullptr);
  for (const glm::vec3& p : mesh.positions)
    if (!is_finite(p)) return "a position is not finite";
  if (!are_materials(data, mesh.materials)) return "a material is not there";
  constexpr NodeId several = no_id - 1;
  std::vector<NodeId> parent(mesh.positions.size(), no_id);  // per vertex, parent of the patches that use it
  for (const Patch& patch : hlod.patches(n))
    for (std::uint32_t i = patch.first_index; i < patch.first_index + patch.index_count; i += 3) {
      const std::uint16_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
      if (std::max({a, b, c}) >= mesh.positions.size()) return "an index is out of range";
      if (a == b || b == c || c == a) return "a triangle repeats a corner";
      if (!is_of_one_material(mesh.materials, a, b, c)) return "a triangle has corners of several materials";
      for (const std::uint16_t v : {a, b, c})
        parent[v] = parent[v] == no_id || parent[v] == patch.parent ? patch.parent : several;
    }
  for (std::size_t v = 0; v < parent.size(); ++v) {
    if (mesh.merged_into[v] == stays) continue;
    if (parent[v] >= several) return "a vertex is merged, but not by one parent";
    if (mesh.merged_into[v] >= hlod.node(parent[v]).vertices) return "a vertex is merged into one that is not there";
  }
  return {};
}

std::optional<std::string> check_within(const HlodView& data, NodeId n) {
  const Hlod hlod(data, nullptr);
  if (!hlod.has_within(n)) return {};
  const NodeSplits within = hlod.within(n);
  const std::size_t first = hlod.node(n).vertices + std::size_t{data.within[n].bare};  // first that a split brings back
  const std::size_t vertices = first + within.parents.size();
  if (!std::ranges::all_of(within.positions, is_finite)) return "a position is not finite";
  if (!are_materials(data, within.materials)) return "a material is not there";
  for (std::size_t s = 0; s < within.parents.size(); ++s) {
    if (within.parents[s] >= first + s) return "a split comes before one that it needs";
    if (!is_length(within.errors[s]) || (s > 0 && within.errors[s] > within.errors[s - 1]))
      return "the errors of splits do not descend";
  }
  for (std::size_t i = 0; i < within.indices.size(); i += 3) {
    const std::uint16_t a = within.indices[i], b = within.indices[i + 1], c = within.indices[i + 2];
    if (std::max({a, b, c}) >= vertices) return "an index is out of range";
    if (a == b || b == c || c == a) return "a triangle repeats a corner";
  }
  return {};
}

}  // namespace occlod::hlod
