// Space as a tree of view cells: where the eye may be, which cell it is in, which cells are near.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/cell_builder.h"
#include "occlod/hierarchy.h"
#include "occlod/mesh.h"
#include "occlod/refiner.h"

namespace occlod {

// Index of a node of a CellTree; no_id: none.
using CellId = std::uint32_t;

// A node: a box of space. The boxes of the leaves are the view cells. Nodes are numbered in depth-first order, a parent
// before its children, so the nodes below `n` are n + 1 to end - 1.
struct CellNode {
  CellBox box;                        // holds the boxes of all nodes below, which touch but do not overlap (those of
                                      // different regions may)
  std::uint64_t payload = 0;          // where what it adds begins, bytes from the start of section DATA
  std::uint64_t checksum = 0;         // XXH3-64 of that
  std::uint32_t payload_bytes = 0;    // and its length
  CellId parent = no_id;              // no_id: of the first node, which is the root
  CellId end = 0;                     // one past the last node below
  std::uint32_t level = 0;            // nodes above it
  std::uint32_t splits = 0;           // that it adds, of all objects
  std::uint32_t hidden_faces = 0;     // that it adds
  std::uint32_t triangles = 0;        // of a leaf: active ones in its cut
  std::uint32_t drawn_triangles = 0;  // of a leaf: of these, to draw
  float error_px = 0.0F;              // of a leaf: how far anything seen is from what is drawn, at most
  std::uint32_t candidates = 0;       // CellAdditions::candidates
};

// Immutable; any number of threads may use one.
class CellTree {
 public:
  // Makes a tree of nodes. Throws Error when `nodes` are no tree in depth-first order, a box is not finite or inverted,
  // or reaches out of its parent's. `subject`: of the error. O(nodes).
  CellTree(std::vector<CellNode> nodes, const std::string& subject);

  // Returns all nodes, at least one.
  [[nodiscard]] std::span<const CellNode> nodes() const noexcept { return nodes_; }
  // Returns a node; cell < nodes().size().
  [[nodiscard]] const CellNode& node(CellId cell) const noexcept { return nodes_[cell]; }
  // Tells whether it is a view cell: no node is below it.
  [[nodiscard]] bool is_leaf(CellId cell) const noexcept { return nodes_[cell].end == cell + 1; }
  // Counts the view cells.
  [[nodiscard]] std::uint32_t leaf_count() const noexcept { return leaf_count_; }

  // Returns the leaf whose closed box holds the eye (world space), that with the smallest id on a border; no_id outside
  // all. O(depth).
  [[nodiscard]] CellId leaf_of(const glm::dvec3& eye) const;
  // Returns the leaf whose box is nearest to the eye, that with the smallest id if several are. O(depth), typically.
  [[nodiscard]] CellId nearest_leaf(const glm::dvec3& eye) const;
  // Finds all leaves whose closed boxes meet the closed box, ascending. Clears `out`.
  void leaves_in(const CellBox& box, std::vector<CellId>& out) const;
  // Finds the leaves that share a piece of a face with this one, ascending. Clears `out`.
  void neighbours(CellId leaf, std::vector<CellId>& out) const;
  // Lists the nodes from the root to the cell, both with it. Clears `out`.
  void path_to(CellId cell, std::vector<CellId>& out) const;
  // Returns the deepest node that is above both or one of them.
  [[nodiscard]] CellId common_ancestor(CellId a, CellId b) const noexcept;

 private:
  std::vector<CellNode> nodes_;
  std::uint32_t leaf_count_ = 0;
};

// The .vlod file: what to draw in each cell of space, as a tree of what cells have in common. The layout is described
// in docs/internals/formats.md.

// The version of the files that are written; open_vlod() refuses any other.
inline constexpr std::uint32_t vlod_version = 1;
// The version of packed files, which it reads as well: those that hold the geometry of their cells (pack_cells()).
inline constexpr std::uint32_t packed_vlod_version = 2;
// The version of those among them with texture coordinates, materials or seams.
inline constexpr std::uint32_t textured_vlod_version = 3;

// What one node of the tree adds for one object.
struct ObjectAdditions {
  std::uint32_t object = 0;     // index of the object
  std::vector<SplitId> splits;  // ascending: applied in all leaves below, and by no node above
  std::vector<FaceRef> hidden;  // by split (the base mesh first), then slot: faces that are active in some leaf
                                // below and drawn in none, and that no node above has. Their splits may be added
                                // further down
};

// What one node of the tree adds to those above it. *The cell of a leaf* is all that the nodes on its path add: the
// splits together, which are closed under dependency at every node of the path, and of their active faces those to draw
// that are hidden by no node of the path and, where the object is not two-sided, do not face away from the leaf's box
// (CellView::faces_away()). What two nodes of one path add has nothing in common.
struct CellAdditions {
  std::vector<ObjectAdditions> objects;  // those for which there is something, ascending
  // Splits that several children of the node apply in some leaf, and not all in all leaves: what children add is stored
  // as places in this list. Splits of all objects are numbered through. For VlodFile::read().
  std::vector<std::uint32_t> candidates;
  // Returns what it takes in memory, about.
  [[nodiscard]] std::size_t bytes() const noexcept;
};

namespace vlod {
class PackedGeometry;
struct StoredObject;
}  // namespace vlod

// What the faces of one object look like.
struct SurfaceMaterials {
  std::span<const Material> materials;  // that materials of wedges index
  std::span<const Texture> textures;    // that materials index; files are named relative to that of the mesh
  TextureOrigin texture_origin = TextureOrigin::bottom_left;  // of texture coordinates
};

// What the geometry of a packed file takes.
struct PackedCounts {
  std::uint64_t splits = 0;     // of all different hierarchies, that some cell applies
  std::uint64_t bytes = 0;      // of the file, of these splits and their vertices
  std::uint64_t frames = 0;     // read one by one
  std::uint64_t raw_bytes = 0;  // of all frames, decoded
};

// An open file. Immutable; any number of threads may read from one. Of the file itself only the header, the options and
// the nodes are in memory. What is open stays readable when the file is removed or replaced by another.
class VlodFile {
 public:
  ~VlodFile();
  VlodFile(const VlodFile&) = delete;
  VlodFile& operator=(const VlodFile&) = delete;

  // Returns the cells.
  [[nodiscard]] const CellTree& tree() const noexcept;
  // Returns the options that it was built with.
  [[nodiscard]] const CellTreeOptions& options() const noexcept;
  // Returns the number of objects that the cells were built for.
  [[nodiscard]] std::size_t object_count() const noexcept;
  // Returns the key of scene and options: files of one key hold the same.
  [[nodiscard]] const std::array<std::uint64_t, 2>& key() const noexcept;
  // Returns one of vlod_version, packed_vlod_version and textured_vlod_version.
  [[nodiscard]] std::uint32_t version() const noexcept;
  // Returns the size of the file.
  [[nodiscard]] std::uint64_t file_bytes() const noexcept;

  // Tells whether it holds the geometry of its cells.
  [[nodiscard]] bool is_packed() const noexcept;
  // Returns what the geometry takes; zeros where there is none.
  [[nodiscard]] PackedCounts packed_counts() const noexcept;
  // Returns the materials of an object, object < object_count(); nothing where it is not packed. Valid as long as the
  // file.
  [[nodiscard]] SurfaceMaterials materials(std::uint32_t object) const noexcept;
  // Returns the geometry for the library's own use; null where there is none.
  [[nodiscard]] const vlod::PackedGeometry* geometry() const noexcept;
  // For the library's own use.
  [[nodiscard]] std::span<const vlod::StoredObject> objects() const noexcept;

  // Reads what a node adds. `ancestors`: what the nodes above it add, from the root to its parent;
  // tree().node(cell).level of them. Reads the file at once, by one pread; waits for the disk. Checks checksum, sizes,
  // that ids ascend and are in range, and, where the file was opened with its objects, that every split that another
  // needs is there and every face exists. Of a packed file that was opened without objects splits have the numbers of
  // the file, not of a hierarchy. Throws Error that names the file and the node. Any number of threads may call it.
  // O(bytes).
  [[nodiscard]] CellAdditions read(CellId cell, std::span<const CellAdditions* const> ancestors) const;
  // Tells whether it was opened with its objects.
  [[nodiscard]] bool has_objects() const noexcept;

 private:
  friend std::shared_ptr<const VlodFile> open_vlod(const std::filesystem::path& path);
  friend std::shared_ptr<const VlodFile> open_vlod(const std::filesystem::path& path,
                                                   std::span<const RefineObject> objects,
                                                   std::span<const std::string> names);
  class Impl;
  explicit VlodFile(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// Opens a file and checks all but what nodes add, which read() does. Throws Error that says what is wrong and where.
// O(nodes).
[[nodiscard]] std::shared_ptr<const VlodFile> open_vlod(const std::filesystem::path& path);
// Opens a file for these objects, whose hierarchies outlive the file. Throws Error also when they are not those that
// the cells were built for: it says which is not, by its name, if there are `names`: none, or one for each object.
// O(nodes + bytes of the hierarchies), of which it reads all.
[[nodiscard]] std::shared_ptr<const VlodFile> open_vlod(const std::filesystem::path& path,
                                                        std::span<const RefineObject> objects,
                                                        std::span<const std::string> names = {});

// Reads what to draw in the cell of a leaf, as the CellBuilder gave it: for each object. `objects`: that the file was
// opened with. Reads the whole path. Throws Error as VlodFile::read() does. O(size of the cut).
[[nodiscard]] std::vector<CellObjectCut> read_cell(const VlodFile& file, std::span<const RefineObject> objects,
                                                   CellId leaf);

// What to draw of one object, by itself.
struct CellObjectMesh {
  std::vector<Triangle> triangles;             // of these wedges: vertices, each with one set of attributes
  std::vector<glm::vec3> positions;            // object space
  std::vector<glm::vec3> normals;              // one for each wedge, or none
  std::vector<glm::u8vec4> colors;             // likewise
  std::vector<glm::vec2> texture_coordinates;  // likewise
  std::vector<MaterialId> materials;           // likewise, of the faces there; see VlodFile::materials()
};
// Reads the same of a packed file that was opened without its objects: for each object. Also of a node that is no leaf:
// all that its cells have in common, but for what faces away from its box. Reads the whole path and the geometry of its
// splits. Throws Error as VlodFile::read() does, and where the geometry is damaged or does not fit together.
[[nodiscard]] std::vector<CellObjectMesh> read_cell(const VlodFile& file, CellId cell);

}  // namespace occlod
