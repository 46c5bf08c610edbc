// Hierarchical levels of detail: a mesh cut into nodes of some thousand triangles, level by level coarser, each node a
// small indexed mesh that is drawn as a whole or in few patches. Built once, immutable. Level 0 is the input; a parent
// is coarser, a child finer. Lengths are object units.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/bounds.h"
#include "occlod/mesh.h"
#include "occlod/view.h"

namespace occlod::hlod {

// Takes pieces of a mesh.
class TriangleSink {
 public:
  virtual ~TriangleSink() = default;
  // A piece: any triangle soup, with ids into its own positions. Normals and colours are kept when every piece has
  // them, texture coordinates when any has: the others lie at (0, 0). Each piece has the materials and textures of
  // those before it, perhaps with more behind them, or none. All have the origin of the first piece, or are moved to
  // it. Throws Error as clean() does.
  virtual void add(const TriangleMesh& piece) = 0;
  // What was counted when one of the objects that the pieces are cut from was read: polygons and vertices as its file
  // has them, which pieces do not show, vertices that no triangle uses, and what was left out. A source tells it of
  // each of its objects or of none; sinks that make no report ignore it.
  virtual void add_counts(const MeshReport& /*of_object*/) {}
};

// Gives all its triangles to a sink, in pieces of a size that fits into memory, some hundred thousand triangles each.
// Called once or several times; gives the same each time.
using TriangleSource = std::function<void(TriangleSink& sink)>;

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

// What is known of a node without its mesh.
struct Node {
  Box box;             // holds all triangles of level 0 that it stands for, those that have vanished too
  Box lod_box;         // of `box` and the lod_boxes of the children
  Sphere sphere;       // contains `box` and the children's spheres
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

// The nodes of one level are consecutive.
struct Level {
  NodeId first_node = 0;         // the level's nodes are [first_node, first_node + node_count)
  std::uint32_t node_count = 0;  // > 0
};

// Marks vertices in NodeMesh::merged_into that stay where they are.
inline constexpr std::uint16_t stays = 0xffff;

// The mesh of one node. Attributes are those of vertices of the input, bit for bit, and so are positions on level 0; on
// others vertices that lie within one node are where they fit the input best. Where the input has seams, a vertex of it
// may be several here, one for each set of its attributes that the node uses.
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
  // Where HlodView::node_images has one: an image of the node's own (PNG or JPEG), and by vertex its place there, as
  // shares of 65,535 of width and height from the top left. They take the place of texture_coordinates and of the image
  // of those materials that HlodView::image_materials marks; other vertices are at (0, 0).
  std::span<const std::uint8_t> image = {};
  std::span<const glm::u16vec2> image_coordinates = {};  // one per vertex, as said above; empty without an image
};

// Where a node's own image is.
struct NodeImage {
  std::uint64_t place = 0;     // in HlodView::images
  std::uint64_t checksum = 0;  // XXH3-64 of it
  std::uint32_t bytes = 0;     // of the coordinates of all vertices, 4 each, and the image behind them; 0: it has none
  float texel_size = 0.0F;     // of the largest texel that is larger than its source's, object units; 0: none
};

// What refinement within a node needs, beside its mesh.
struct NodeWithin {
  std::uint64_t place = 0;      // of its splits in HlodView::splits, a multiple of mesh_alignment
  std::uint32_t splits = 0;     // 0: the node can be drawn as it is only
  std::uint32_t bare = 0;       // vertices without triangles in the node's mesh that no collapse moved
  std::uint32_t triangles = 0;  // that the node was made from
  std::uint32_t reserved = 0;   // always 0
};

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

// The triangles of a node from here to the next run belong to one feature.
struct FeatureRun {
  std::uint32_t first_triangle = 0;  // of the node's mesh: its indices begin at three times as much
  FeatureId feature = 0;             // into HlodFeatures::names
};

// Which part of the input each triangle belongs to, see TriangleMesh::triangle_features. Triangles keep it when they
// are simplified, and no vertex is used by two features. All empty where the input had fewer than two.
struct HlodFeatures {
  std::span<const std::string> names;        // UTF-8
  std::span<const FeatureRun> runs;          // node by node; those of a node ascending, the first at triangle 0
  std::span<const std::uint32_t> first_run;  // by node, into runs; then the number of runs
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
  std::uint32_t node_triangles = 0;        // likewise: HlodBuildOptions::node_triangles
  bool has_normals = false;                // whether meshes have them
  bool has_colors = false;                 // likewise
  std::span<const NodeWithin> within;      // by node; empty without HlodBuildOptions::within
  std::span<const std::byte> splits;       // of all nodes: the arrays of NodeSplits
  bool has_texture_coordinates = false;    // whether meshes have them
  bool has_materials = false;              // whether meshes say which material their vertices have
  bool has_seams = false;                  // whether vertices of one mesh may lie at one place
  std::span<const Material> materials;     // that NodeMesh::materials index
  std::span<const Texture> textures;       // that materials index
  TextureOrigin texture_origin = TextureOrigin::bottom_left;  // of texture coordinates
  float lattice_step = 0.0F;  // all coordinates are multiples of it, HlodBuildOptions::quantise_bits; 0: as the input's
  glm::dvec3 origin{0.0};     // coordinates are origin + position, see TriangleMesh::origin and positions_to_world()
  UpAxis up = UpAxis::z;      // of the input
  std::span<const NodeImage> node_images;         // by node; empty where nodes have no images of their own
  std::span<const std::byte> images;              // that node_images tells of; empty of an HLOD with a store
  std::span<const std::uint8_t> image_materials;  // by material: 1 where nodes show it by their own images
  HlodFeatures features;                          // of all nodes
};

inline constexpr std::size_t mesh_alignment = 16;  // of a node's mesh in HlodView::meshes, and of its splits

class NodeGuard;
class NodeStore;

// Immutable; copies share their arrays. Any number of threads may read one; of one with a store() only the thread that
// uses the store may read meshes.
class Hlod {
 public:
  // Makes an HLOD of nothing, without nodes.
  Hlod() = default;
  // Takes arrays that `owner` keeps alive and that do not change. Their sizes and indices fit together:
  // check_structure() returns nothing.
  Hlod(const HlodView& view, std::shared_ptr<const void> owner);

  // Returns the arrays. Of an HLOD in a mapped file meshes have been checked only where require() was called.
  [[nodiscard]] const HlodView& data() const noexcept { return view_; }
  // Counts the nodes of all levels.
  [[nodiscard]] std::size_t node_count() const noexcept { return view_.nodes.size(); }
  // Counts the levels, from the input to the coarsest.
  [[nodiscard]] std::size_t level_count() const noexcept { return view_.levels.size(); }
  // Returns what is known of node n < node_count().
  [[nodiscard]] const Node& node(NodeId n) const noexcept { return view_.nodes[n]; }
  // Returns the patches of node n: one for each parent, or one of a root.
  [[nodiscard]] std::span<const Patch> patches(NodeId n) const noexcept {
    return view_.patches.subspan(node(n).first_patch, node(n).patches);
  }
  // Returns the nodes that node n replaces in part, ascending.
  [[nodiscard]] std::span<const NodeId> children(NodeId n) const noexcept {
    return view_.children.subspan(node(n).first_child, node(n).children);
  }
  // Returns the features of the triangles of node n; none where the input had none.
  [[nodiscard]] std::span<const FeatureRun> features(NodeId n) const noexcept {
    const HlodFeatures& all = view_.features;
    if (all.first_run.empty()) return {};
    return all.runs.subspan(all.first_run[n], all.first_run[n + 1] - all.first_run[n]);
  }
  // Returns the store whose meshes come and go (node_store.h); null where all are always there.
  [[nodiscard]] NodeStore* store() const noexcept { return store_; }
  // Tells whether the mesh of node n is there; always without a store.
  [[nodiscard]] bool is_resident(NodeId n) const noexcept { return resident_ == nullptr || resident_[n] != nullptr; }
  // Call before the first use of the mesh of node n: checks the part of a mapped file that holds it, and throws Error
  // when it is damaged; with a store, when it is not there. Nothing to do for other HLODs and when it has been checked
  // before.
  void require(NodeId n) const {
    if (!is_resident(n) || (checked_ != nullptr && !checked_[n].load(std::memory_order_acquire))) check_mesh(n);
  }
  // Tells whether node n can be refined within: it has splits. n < node_count().
  [[nodiscard]] bool has_within(NodeId n) const noexcept { return !view_.within.empty() && view_.within[n].splits > 0; }
  // Call before the first use of the splits of node n; otherwise like require().
  void require_within(NodeId n) const {
    if (within_checked_ != nullptr && !within_checked_[n].load(std::memory_order_acquire)) check_within(n);
  }
  // Does both for all nodes. Throws Error for an HLOD with a store. O(bytes) the first time.
  void require_all() const;
  // Returns the mesh of node n, which has been required.
  [[nodiscard]] NodeMesh mesh(NodeId n) const noexcept;
  // Returns the splits of node n, which has_within() and whose splits have been required.
  [[nodiscard]] NodeSplits within(NodeId n) const noexcept;
  // Returns the bytes that the arrays occupy; meshes in a store do not count.
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

// The invariants of an HLOD, checked without trusting anything in it. Tests call this after every build and load.

// Checks that sizes and indices of the arrays fit together, so that an Hlod made from them can be traversed safely:
// levels are runs of nodes, patches divide a node's triangles and name parents one level up, children are the nodes
// whose patches name them, meshes and splits lie within their arrays. Meshes and splits are not looked at. Returns what
// is wrong, or nothing. O(nodes + patches).
[[nodiscard]] std::optional<std::string> check_structure(const HlodView& data);

// Checks that the mesh of node n can be drawn: indices and merged_into in range, positions finite. `data` has passed
// check_structure(). Returns what is wrong, or nothing. O(size of the mesh).
[[nodiscard]] std::optional<std::string> check_mesh(const HlodView& data, NodeId n);

// Checks the same for its splits: their parents come before them, errors are finite and descend. O(size of the splits).
[[nodiscard]] std::optional<std::string> check_within(const HlodView& data, NodeId n);

// Checks six invariants: (1) no error is smaller than a child's, and boxes and spheres contain what they say; (2) all
// vertices of a node are where vertices of its children are or slide to; (3) the triangles of a node are those of its
// children that it replaces, with its merges applied, where degenerate ones vanish and opposite ones cancel; (4) where
// borders are locked, every vertex is merged in one node only, and the oriented boundary of `random_fronts` random
// legal fronts is that of the input with the merges of all coarser nodes applied: no crack opens between nodes of
// different levels; (5) of nodes with splits, all splits together give the triangles that the node was made from, and
// none of them its mesh, triangle for triangle; their errors descend from that of the node; and (4) holds too for
// fronts on which nodes whose parents are all refined are drawn with a random number of their splits; (6) every
// triangle of level 0 is in the boxes of its node and of nodes through which that is reached from a root, so that no
// view of it can do without. Returns one line per violation (at most 20), none when all hold. Throws Error when a
// mapped file is damaged. O(size + nodes * random_fronts); with splits O(size * random_fronts).
[[nodiscard]] std::vector<std::string> validate(const Hlod& hlod, std::size_t random_fronts = 64);

// Returns true iff the nodes of level 0 together are exactly the triangles of `mesh`, rounded to the HLOD's lattice and
// cleaned if it has one: the same positions in the same rotational order, each as often, with the same material and, at
// each corner, the same of those attributes that the mesh has, to the bit; v of another texture origin counts as 1 - v.
// O(n log n).
[[nodiscard]] bool restores(const Hlod& hlod, const TriangleMesh& mesh);

// Tells the same of a source, whose pieces are read once: compares how many triangles there are, and sums of hashes
// (128 bits) of their positions alone. Triangles with two corners at one place do not count. Meshes of the HLOD are
// checked one by one; O(n) time, memory for one piece.
[[nodiscard]] bool restores(const Hlod& hlod, const TriangleSource& source);

// The error of a node on the screen.

// An eye in object space, and how lengths of the object appear from there.
struct ScreenScale {
  glm::dvec3 eye{0.0};           // its place, object space; where rays are parallel, of no meaning
  double focal_length_px = 1.0;  // pixels that one world unit across the line of sight covers at distance 1, or
                                 // anywhere where rays are parallel
  double min_distance = 1e-30;   // > 0, world units: of the near plane
  // World units per object unit along each axis, or less: distances are measured with it. Exact unless the placement
  // shears.
  glm::dvec3 axis_stretch{1.0};
  double largest_stretch = 1.0;  // world units per object unit at most: errors are measured with it
  bool orthographic = false;     // rays are parallel: errors look the same at every distance
};

// Returns the scale of an object in a view: `object` was made for `view`.
[[nodiscard]] ScreenScale screen_scale(const View& view, const ObjectView& object);

// Returns the world units from the eye to the nearest point of the box, or less where the placement shears; not for
// parallel rays.
[[nodiscard]] double distance_to(const Box& box, const ScreenScale& scale);

// Returns the pixels that the node's error covers at most where the node is nearest to the eye: the larger of its own
// error at its box and its children's at its lod_box. No less than for any child of the node, seen from anywhere, so a
// front of nodes whose error is below a tolerance is legal as it is.
[[nodiscard]] double screen_error_px(const Node& node, const ScreenScale& scale);

// Returns the same by the nearest point of the node's sphere, as published methods have it: coarser, and no less than
// for any child either.
[[nodiscard]] double sphere_error_px(const Node& node, const ScreenScale& scale);

// Returns the pixels that Node::guaranteed_error covers at most: seen from the eye, no point of the node's triangles is
// farther from the input. By the nearest point of lod_box, so no less than for any child.
[[nodiscard]] double guaranteed_error_px(const Node& node, const ScreenScale& scale);

// Returns screen_error_px() of a node that is refined within as far as possible: what is left is its children's error,
// at its lod_box. No less than the error of any child, so on a front of nodes for which it is below a tolerance, those
// whose own error is not can be refined within.
[[nodiscard]] double min_screen_error_px(const Node& node, const ScreenScale& scale);
// Returns the same by the sphere.
[[nodiscard]] double min_sphere_error_px(const Node& node, const ScreenScale& scale);

// Returns the error in object units that covers so many pixels where the node's box is nearest to the eye. For
// within_cut().
[[nodiscard]] double screen_error_limit(const Node& node, const ScreenScale& scale, double pixels);
// Returns the same for the sphere.
[[nodiscard]] double sphere_error_limit(const Node& node, const ScreenScale& scale, double pixels);

}  // namespace occlod::hlod
