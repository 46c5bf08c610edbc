// Clusters for the renderers of others: a mesh as levels of small clusters, of which any eye draws its own choice
// without cracks. What meshoptimizer's clusterlod.h gives, from our simplifier: the same rule, the same kind of arrays.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/bounds.h"
#include "occlod/build_hierarchy.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"

namespace occlod::hlod {

// A cluster has no more vertices than 8 bits can number.
inline constexpr std::uint32_t max_cluster_vertices = 256;

// The error of groups that nothing coarser replaces.
inline constexpr float endless_error = std::numeric_limits<float>::max();

// Some triangles that are drawn together or not at all. It is drawn iff the error of its group, seen from the eye, is
// above the tolerance, and that of the group that it was simplified from is not, or there is none.
struct Cluster {
  Sphere sphere;                   // holds its triangles; for culling
  float error = 0.0F;              // of drawing it instead of the input: that of groups[refined]; 0 on level 0
  std::uint32_t first_index = 0;   // into ClusterLod::indices
  std::uint32_t index_count = 0;   // three for each triangle
  std::uint32_t vertex_count = 0;  // different ones; at most max_cluster_vertices
  std::uint32_t group = 0;         // into ClusterLod::groups: what replaces it, together with others
  std::uint32_t refined = no_id;   // the group that it was simplified from; no_id: triangles of the input
  MaterialId material = 0;         // of all its triangles, into TriangleMesh::materials
  std::uint32_t level = 0;         // 0: the input
};

// Clusters that are simplified together: all of them are replaced at once, by the clusters whose `refined` it is.
struct ClusterGroup {
  Sphere sphere;                // holds its clusters and the spheres of the groups that these were simplified from
  float error = endless_error;  // of what replaces it, instead of the input, object units: about an RMS, or measured
                                // (ClusterOptions::error_bound); no less than those of groups that its clusters
                                // were simplified from
  std::uint32_t first_cluster = 0;  // into ClusterLod::clusters
  std::uint32_t cluster_count = 0;  // from there on
  std::uint32_t level = 0;          // of its clusters
};

// All levels of a mesh. The clusters of one level follow each other, the finest first, and so do those of a group.
struct ClusterLod {
  TriangleMesh vertices;               // the vertices of all levels, materials and textures; no triangles
  std::vector<ClusterGroup> groups;    // level by level
  std::vector<Cluster> clusters;       // group by group
  std::vector<std::uint32_t> indices;  // into the arrays of `vertices`; those of level 0 are sorted by material
  std::uint64_t input_triangles = 0;   // of level 0

  // Counts the triangles of all levels.
  [[nodiscard]] std::uint64_t stored_triangles() const noexcept { return indices.size() / 3; }
};

// How clusters are made.
struct ClusterOptions {
  std::uint32_t max_triangles = 128;  // of a cluster; in [32, 256]
  // Of ClusterGroup::error: `accumulated` is what clusterlod has, about an RMS; with `measured` no drawn point is
  // farther from the input, which takes about twice as long to build.
  ErrorBound error_bound = ErrorBound::accumulated;
  int threads = 0;  // in [0, 1024]; 0: one for each core. The result does not depend on it
  // Called now and then with the share done, in [0, 1]; returning false cancels, which throws Error.
  std::function<bool(double)> progress = {};
};

// Makes clusters of any triangle soup that clean() accepts. Vertices are those of the input, bit for bit, and so are
// their attributes; where a simplified chart covers a vertex that had none of it, a vertex is added. Throws Error as
// build_hlod() does. O(n log n).
[[nodiscard]] ClusterLod build_clusters(const TriangleMesh& mesh, const ClusterOptions& options = {});

// How clusters are written.
struct ClusterFileOptions {
  bool compresses = false;  // by EXT_meshopt_compression, without loss; needs a build with meshoptimizer
  // That names of images are relative to; empty: the folder of the file.
  std::filesystem::path image_folder = {};
};

// Writes a binary glTF file whose one mesh is the input, as anything that reads glTF shows it, and whose `extras` name
// the arrays of all levels: docs/internals/formats.md#clusters. Holds the images of textures. Writes beside `path` and
// renames. Returns a line for each image that is left out. Throws Error that names the file, and for compression in a
// build without meshoptimizer. O(size).
std::vector<std::string> write_clusters(const std::filesystem::path& path, const ClusterLod& lod,
                                        const ClusterFileOptions& options = {});

// Returns the pixels that an error covers at most as clusterlod.h has it, times the height of the picture: the error
// over the distance of the eye to the sphere. `scale_px` is the focal length in pixels, `near` the least distance.
[[nodiscard]] double projected_error(const Sphere& sphere, float error, const glm::dvec3& eye, double scale_px,
                                     double near);

}  // namespace occlod::hlod
