// Hierarchical levels of detail: a mesh cut into nodes of some thousand triangles, level by level coarser, each node a
// small indexed mesh that is drawn as a whole or in few patches. Built once, immutable. Level 0 is the input; a parent
// is coarser, a child finer. Lengths are object units.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>

#include "occlod/core/ids.h"
#include "occlod/math/bounds.h"
#include "occlod/mesh/triangle_mesh.h"

namespace occlod::hlod {

using NodeId = std::uint32_t;  // into HlodView::nodes, from coarse to fine: parents come before their children

// How triangles of one level are grouped into the nodes of the next.
enum class Grouping : std::uint32_t {
  nested,   // by one octree for all levels: every node has one parent
  shifted,  // by an octree that is moved by a third from level to level, so that borders do not stay where they are
};

// What simplification does with vertices that several nodes of a level share.
enum class Borders : std::uint32_t {
  free,    // each node moves its own copy: neighbours of different levels leave gaps, as wide as their errors at most
  locked,  // they stay until a node has them inside: no gaps
};

// The triangles of a node that one parent replaces: drawn iff that parent is refined and the node is not.
struct Patch {
  NodeId parent = no_id;          // no_id: of a root, drawn whenever the root is not refined
  std::uint32_t first_index = 0;  // into NodeMesh::indices
  std::uint32_t index_count = 0;  // a multiple of 3, > 0
};
static_assert(sizeof(Patch) == 12);

// What is known of a node without its mesh.
struct Node {
  Box box;        // of the level-0 vertices that ended up in vertices of the node's input: holds all that it stands for
  Box lod_box;    // of `box` and the lod_boxes of the children
  Sphere sphere;  // contains `box` and the children's spheres
  float error = 0.0F;  // of drawing this node instead of the input: how far the surface is off, or texture and other
                       // attributes on it if that is more; no less than a child's; 0 on level 0
  float child_error = 0.0F;       // the largest error of a child
  float guaranteed_error = 0.0F;  // no point of the node's triangles is farther from the input; no less than a child's
  float area = 0.0F;              // of the node's triangles, square units
  std::uint32_t first_patch = 0;  // into HlodView::patches
  std::uint32_t first_child = 0;  // into HlodView::children
  std::uint32_t triangles = 0;    // of the mesh; may be none where everything has vanished
  std::uint32_t vertices = 0;     // of the mesh; less than 65,536
  std::uint16_t patches = 0;      // none only for a node without triangles
  std::uint16_t children = 0;     // none on level 0, at least one elsewhere
  std::uint16_t level = 0;        // into HlodView::levels
  std::uint16_t reserved = 0;     // always 0
  std::uint64_t mesh = 0;         // place of its mesh in HlodView::meshes, a multiple of mesh_alignment
};
static_assert(sizeof(Node) == 112);

// The nodes of one level are consecutive.
struct Level {
  NodeId first_node = 0;         // the level's nodes are [first_node, first_node + node_count)
  std::uint32_t node_count = 0;  // > 0
};

// For NodeMesh::merged_into.
inline constexpr std::uint16_t stays = 0xffff;

// The mesh of one node. Positions are those of vertices of the input, bit for bit, and so are attributes. Where the
// input has seams, a vertex of it may be several here, one for each set of its attributes that the node uses.
struct NodeMesh {
  std::span<const glm::vec3> positions;    // object space
  std::span<const glm::vec3> normals;      // unit length, one per vertex; empty when the input had none
  std::span<const glm::u8vec4> colors;     // sRGB and alpha, one per vertex; empty when the input had none
  std::span<const std::uint16_t> indices;  // three for each triangle, patch by patch
  // By vertex: the vertex of the parent's mesh that it slides to while that parent takes over; the parent is that of
  // the patches which use the vertex. `stays` for vertices that stay where they are, as all do that several parents
  // share.
  std::span<const std::uint16_t> merged_into;
  std::span<const glm::vec2> texture_coordinates;  // as in the input, one per vertex; empty when it had none
  std::span<const MaterialId> materials;  // one per vertex, the same at all corners of a triangle; empty: all 0
};

// What refinement within a node needs, beside its mesh.
struct NodeWithin {
  std::uint64_t place = 0;      // of its splits in HlodView::splits, a multiple of mesh_alignment
  std::uint32_t splits = 0;     // 0: the node can be drawn as it is only
  std::uint32_t bare = 0;       // vertices without triangles in the node's mesh that no collapse moved
  std::uint32_t triangles = 0;  // that the node was made from
  std::uint32_t reserved = 0;   // always 0
};
static_assert(sizeof(NodeWithin) == 24);

// The triangles that a node was made from, and the splits that lead from its mesh back to them, the coarsest first
// (Hoppe 1996, progressive meshes): any number of first splits gives a mesh in between. Vertices are numbered through:
// those of the NodeMesh, then these. Where the input has seams, splits of one place follow each other with one error
// and are applied together.
struct NodeSplits {
  std::span<const glm::vec3> positions;    // NodeWithin::bare vertices, then one for each split, which brings it back
  std::span<const glm::vec3> normals;      // as in NodeMesh
  std::span<const glm::u8vec4> colors;     // as in NodeMesh
  std::span<const float> errors;           // by split, descending: the error of this node's collapses when only the
                                           // splits before it are applied, object units
  std::span<const std::uint16_t> indices;  // three for each triangle, all splits applied
  std::span<const std::uint16_t> parents;  // by split: the vertex, of a smaller number, that its vertex was merged into
  std::span<const glm::vec2> texture_coordinates;  // as in NodeMesh
  std::span<const MaterialId> materials;           // as in NodeMesh
};

// The arrays of an HLOD, in memory of its own or of a file.
struct HlodView {
  std::span<const Node> nodes;             // level by level, the coarsest first; along a Morton curve within a level
  std::span<const Patch> patches;          // node by node; those of a node by ascending parent, one for each
  std::span<const NodeId> children;        // node by node, ascending
  std::span<const NodeId> roots;           // nodes without a parent, ascending
  std::span<const Level> levels;           // from level 0
  std::span<const std::byte> meshes;       // of all nodes: the arrays of NodeMesh; empty of an HLOD with a store
  Box box;                                 // of the input
  std::uint64_t input_triangle_count = 0;  // of level 0
  Grouping grouping = Grouping::shifted;   // how it was built
  Borders borders = Borders::locked;       // likewise
  std::uint32_t node_triangles = 0;        // likewise: BuildOptions::node_triangles
  bool has_normals = false;                // whether meshes have them
  bool has_colors = false;                 // likewise
  std::span<const NodeWithin> within;      // by node; empty without BuildOptions::within
  std::span<const std::byte> splits;       // of all nodes: the arrays of NodeSplits
  bool has_texture_coordinates = false;    // whether meshes have them
  bool has_materials = false;              // whether meshes say which material their vertices have
  bool has_seams = false;                  // whether vertices of one mesh may lie at one place
  std::span<const Material> materials;     // that NodeMesh::materials index
  std::span<const Texture> textures;       // that materials index
  TextureOrigin texture_origin = TextureOrigin::bottom_left;  // of texture coordinates
  float lattice_step = 0.0F;  // all coordinates are multiples of it, BuildOptions::quantise_bits; 0: as the input's
};

inline constexpr std::size_t mesh_alignment = 16;  // of a node's mesh in HlodView::meshes, and of its splits

class NodeGuard;
class NodeStore;

// Immutable; copies share their arrays. Any number of threads may read one; of one with a store() only the thread that
// uses the store may read meshes.
class Hlod {
 public:
  // Of nothing: without nodes.
  Hlod() = default;
  // Arrays that `owner` keeps alive and that do not change. Their sizes and indices fit together: check_structure() in
  // validate.h returns nothing.
  Hlod(const HlodView& view, std::shared_ptr<const void> owner);

  // Of an HLOD in a mapped file meshes have been checked only where require() was called.
  [[nodiscard]] const HlodView& data() const noexcept { return view_; }
  // In all levels.
  [[nodiscard]] std::size_t node_count() const noexcept { return view_.nodes.size(); }
  // From the input to the coarsest.
  [[nodiscard]] std::size_t level_count() const noexcept { return view_.levels.size(); }
  // n < node_count().
  [[nodiscard]] const Node& node(NodeId n) const noexcept { return view_.nodes[n]; }
  // Of node n, one for each parent, or one of a root.
  [[nodiscard]] std::span<const Patch> patches(NodeId n) const noexcept {
    return view_.patches.subspan(node(n).first_patch, node(n).patches);
  }
  // Of node n: the nodes that it replaces in part, ascending.
  [[nodiscard]] std::span<const NodeId> children(NodeId n) const noexcept {
    return view_.children.subspan(node(n).first_child, node(n).children);
  }
  // Whose meshes come and go (node_store.h); null where all are always there.
  [[nodiscard]] NodeStore* store() const noexcept { return store_; }
  // Whether the mesh of node n is there; always without a store.
  [[nodiscard]] bool is_resident(NodeId n) const noexcept { return resident_ == nullptr || resident_[n] != nullptr; }
  // Call before the first use of the mesh of node n: checks the part of a mapped file that holds it, and throws Error
  // when it is damaged; with a store, when it is not there. Nothing to do for other HLODs and when it has been checked
  // before.
  void require(NodeId n) const {
    if (!is_resident(n) || (checked_ != nullptr && !checked_[n].load(std::memory_order_acquire))) check_mesh(n);
  }
  // Whether node n can be refined within: it has splits. n < node_count().
  [[nodiscard]] bool has_within(NodeId n) const noexcept { return !view_.within.empty() && view_.within[n].splits > 0; }
  // Call before the first use of the splits of node n; otherwise like require().
  void require_within(NodeId n) const {
    if (within_checked_ != nullptr && !within_checked_[n].load(std::memory_order_acquire)) check_within(n);
  }
  // Both for all nodes. O(bytes) the first time.
  void require_all() const;
  // Of node n, which has been required.
  [[nodiscard]] NodeMesh mesh(NodeId n) const noexcept;
  // Of node n, which has_within() and whose splits have been required.
  [[nodiscard]] NodeSplits within(NodeId n) const noexcept;
  // That the arrays occupy; meshes in a store do not count.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  friend Hlod guarded_hlod(const HlodView& view, std::shared_ptr<const void> owner, std::shared_ptr<NodeGuard> guard);
  friend Hlod paged_hlod(const std::shared_ptr<NodeStore>& store);
  void check_mesh(NodeId n) const;
  void check_within(NodeId n) const;

  HlodView view_;
  std::shared_ptr<const void> owner_;
  std::shared_ptr<NodeGuard> guard_;
  const std::atomic<bool>* checked_ = nullptr;              // by node, the guard's; null without a guard
  const std::atomic<bool>* within_checked_ = nullptr;       // likewise, of splits
  NodeStore* store_ = nullptr;                              // kept alive by owner_
  const std::unique_ptr<std::byte[]>* resident_ = nullptr;  // by node, the mesh or null; null without a store
};

}  // namespace occlod::hlod
