// Builds the hierarchy of a mesh by half-edge collapses in the order of their quadric error (Garland & Heckbert 1997),
// and validates, cuts, writes and reads hierarchies.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "occlod/hierarchy.h"
#include "occlod/mesh.h"

namespace occlod {

// How SplitNode::guaranteed_error is computed. Both ways give upper bounds.
enum class ErrorBound {
  accumulated,  // the movements of all collapses that led to a face, added up: several times too large on coarse meshes
  measured      // against the input mesh: tight, at several times the building time
};

// Options of build_hierarchy().
struct BuildOptions {
  std::size_t base_triangles = 64;  // collapsing stops at a base mesh of at most this many triangles; it may have fewer
  double boundary_weight = 1.0;     // weight of the planes that hold boundary and non-manifold edges in place, relative
                                    // to the triangles beside them; in [0, 1e6]
  double attribute_weight = 0.7;    // weight of the shift of texture coordinates, normals and colours, relative to
                                    // distances, for meshes with texture coordinates or seams; in [0, 1e6]
  ErrorBound error_bound = ErrorBound::accumulated;  // how bounds on the distance to the input are computed
  int threads = 0;                                   // in [0, 1024]; 0: one per core. The result does not depend on it
  // Called from time to time on the calling thread with the share done, in [0, 1], at last with 1; when it returns
  // false, the build is cancelled and throws Error. An exception that it throws ends the build too.
  std::function<bool(double)> progress = {};
};

// Builds the hierarchy of any triangle soup that clean() accepts. The same mesh and options give the same bytes,
// whatever the number of threads. Throws Error for an option out of its range, for a mesh without triangles, with an
// index out of range, with a position that is not finite or with a coordinate beyond farthest_coordinate, and when
// cancelled. O(n log n) time; needs about 270 bytes a vertex besides the result while building.
[[nodiscard]] Hierarchy build_hierarchy(const TriangleMesh& mesh, const BuildOptions& options = {});

// Checks that sizes and indices of the arrays fit together, so that a Hierarchy made from them can be traversed safely:
// each star ends where the next begins, ids are in range, dependencies and forest parents come first, every split is in
// the forest once. Returns what is wrong, or nothing. O(size).
[[nodiscard]] std::optional<std::string> check_structure(const HierarchyView& data);

// Checks the invariants of a hierarchy without trusting anything in it: (1) no error is smaller than that of a split
// that depends on it or is below it in the forest; (2) sphere, box and cylinder contain all faces of the split and
// those below it; (3) the normal cone contains their normals; (4) applying the splits in order removes only active
// faces and ends with the input triangles, and every random closed set gives a conforming mesh, in which each edge that
// is no boundary of the input is shared; `random_cuts` (>= 0) sets are tried. Returns one line per violation (at most
// 20), none when all hold. Throws Error when a mapped file is damaged. O(size * random_cuts).
[[nodiscard]] std::vector<std::string> validate(const Hierarchy& hierarchy, int random_cuts = 16);

// True iff applying all splits gives exactly the triangles of `mesh`: the same positions in the same rotational order,
// the same number of times, with the same materials, and at each corner the same normal, colour and texture coordinate,
// bit for bit, as far as the mesh has them. Of another texture origin, v counts as 1 - v, rounded as write_mesh()
// rounds it. O(n log n).
[[nodiscard]] bool restores(const Hierarchy& hierarchy, const TriangleMesh& mesh);

// A cut that does not depend on a view: which splits are applied, and what that gives. All cuts below are closed under
// dependency, because splits depend on smaller ids only and errors never grow from a split to those that depend on it;
// so their faces form a conforming mesh.
struct FixedCut {
  std::vector<bool> applied;      // one per split
  std::size_t splits = 0;         // number of applied splits
  std::size_t triangles = 0;      // of the cut
  float guaranteed_error = 0.0F;  // bound on the distance between the cut and the input, object units; 0 = the input
  float error = 0.0F;             // largest error of a split that is not applied, quadric and attribute error
                                  // together, about a root mean square, object units
};

// Applies all splits, which gives the input mesh. O(n). Like all functions for cuts it throws Error when a mapped file
// is damaged.
[[nodiscard]] FixedCut full_cut(const Hierarchy& hierarchy);

// Applies as many of the first splits, which undo the last and costliest collapses, as give at most `max_triangles`;
// returns the base mesh when even that has more. O(n).
[[nodiscard]] FixedCut cut_to_triangles(const Hierarchy& hierarchy, std::size_t max_triangles);

// Returns the smallest cut whose guaranteed error and whose attribute errors are at most `max_error` (>= 0, object
// units): exactly the splits with a larger one are applied. O(n).
[[nodiscard]] FixedCut cut_to_error(const Hierarchy& hierarchy, double max_error);

// Returns the triangles of a cut as ids of the hierarchy's vertices: base faces first, then by split and slot. O(n).
[[nodiscard]] std::vector<Triangle> triangles_of(const Hierarchy& hierarchy, const FixedCut& cut);

// Returns the triangles of a cut as ids of wedges, in the order of triangles_of(): these are the triangles to draw.
// Equal to triangles_of() when no vertex has more than one wedge. O(n).
[[nodiscard]] std::vector<Triangle> wedge_triangles_of(const Hierarchy& hierarchy, const FixedCut& cut);

// Makes a separate mesh from triangles of wedges, such as those of RefinedObject, with the hierarchy's attributes and
// without vertices and wedges that no triangle uses. Vertices are numbered as triangles first use them. O(n).
[[nodiscard]] TriangleMesh mesh_of(const Hierarchy& hierarchy, std::span<const Triangle> wedge_triangles);

// Makes a separate mesh from a cut, as mesh_of() does. O(n).
[[nodiscard]] TriangleMesh cut_mesh(const Hierarchy& hierarchy, const FixedCut& cut);

// Version of .olod files with an origin; others have version 3, or 2 without texture coordinates, materials and seams.
// An .olod file holds a hierarchy as versioned, checksummed sections; docs/internals/formats.md describes the layout.
inline constexpr std::uint32_t olod_version = 4;

// How the arrays of a file are stored.
enum class OlodCompression {
  none,  // as they are in memory: the file can be mapped, so that only what is used is ever loaded
  zstd,  // about half the size or less; decompressed into memory when read
};

// How a file without compression is read.
enum class OlodAccess {
  mapped,  // opening is immediate; pages are loaded as they are used
  copied,  // read into memory as a whole; later changes of the file have no effect
};

// The contents of an .olod file.
struct OlodFile {
  Hierarchy hierarchy;                                  // mapped or in memory
  MeshReport report;                                    // report on the mesh from which it was built
  OlodCompression compression = OlodCompression::none;  // compression of the file
  std::uint32_t version = olod_version;                 // version of the file
};

// Writes beside `path` and renames, so that an existing file stays as it was when writing fails. The same arguments
// give the same bytes. Throws Error that names the file. O(bytes).
//
// `image_folder` is what names of image files are relative to. Where it is given, the names of those that are there are
// written so that they lead to them from the folder of `path`; all others stay as they are.
void write_olod(const std::filesystem::path& path, const Hierarchy& hierarchy, const MeshReport& report,
                OlodCompression compression = OlodCompression::none, const std::filesystem::path& image_folder = {});

// Reads a file and checks magic, version, sizes, the table of sections and the base mesh. The rest is checked (checksum
// and structure) block by block when Hierarchy::require() is first called for a split of the block; require_all()
// checks the whole file. Both throw Error that says what failed and where.
//
// A mapped file must not change while the hierarchy lives. It may be removed, or replaced by renaming another file over
// it, as write_olod() does; but when it is truncated, or its disk fails, POSIX systems answer the next access to a
// missing page with SIGBUS. Where that cannot be ruled out, handle the signal or use OlodAccess::copied.
[[nodiscard]] OlodFile read_olod(const std::filesystem::path& path, OlodAccess access = OlodAccess::mapped);

}  // namespace occlod
