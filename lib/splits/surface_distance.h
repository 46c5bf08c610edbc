// Measures how far two surfaces are from each other, at every point of them and not at samples only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "occlod/bounds.h"
#include "occlod/mesh.h"

namespace occlod {

// Refers to a surface of at least one face. Faces that are near each other in it should be so in space, too.
struct SurfaceView {
  std::span<const glm::vec3> positions;
  std::span<const Triangle> faces;
};

// A tree of boxes over consecutive faces, to find those near a point. The arrays must outlive it. O(n) to build.
class SurfaceTree {
 public:
  explicit SurfaceTree(const SurfaceView& surface);

  [[nodiscard]] glm::dvec3 corner(std::uint32_t face, int k) const {
    return glm::dvec3(surface_.positions[surface_.faces[face][k]]);
  }
  // Returns a face across the side that begins at corner k; no_id when none is known.
  [[nodiscard]] std::uint32_t neighbour(std::uint32_t face, int k) const { return neighbours_[face][k]; }
  [[nodiscard]] double distance2(std::uint32_t face, const glm::dvec3& p) const;
  struct Found {
    std::uint32_t face = no_id;
    double distance2 = std::numeric_limits<double>::infinity();
  };
  // Returns the nearest face, or any whose squared distance is at most `enough2`. Looks first at the face `hint` unless
  // it is no_id. Typically O(log n).
  [[nodiscard]] Found nearest(const glm::dvec3& p, double enough2, std::uint32_t hint) const;

 private:
  static constexpr std::size_t fan_out = 4;  // faces of a leaf, and children of a node

  static constexpr std::ptrdiff_t most_at_vertex = 64;  // faces among which neighbours are searched

  void find_neighbours();

  SurfaceView surface_;
  std::vector<std::vector<Box>> levels_;  // around fan_out faces, then around fan_out boxes of the level before
  std::vector<Triangle> neighbours_;      // of each face, by side
};

// A face with a point that is farther from a surface than it may be, and a face of the surface near that point.
struct FarFace {
  std::uint32_t face = no_id;
  std::uint32_t near = no_id;
};

// Returns the faces of `from` that have points farther than `limit` (> 0, object units) from the surface of the tree,
// ascending; faces with no point farther than 0.98 of it are not among them, others may be. Returns nothing when there
// are more than `most`. A face is convex, so the distance from one face is a convex function: no point of a polygon is
// farther from it than the farthest corner. Faces are cut into polygons, each over one face of the other surface, until
// that bound will do. The same for any number of threads.
[[nodiscard]] std::optional<std::vector<FarFace>> faces_beyond(double limit, std::size_t most, const SurfaceView& from,
                                                               const SurfaceTree& to, unsigned threads);

// Returns the largest distance of the vertices that faces use from the surface of the tree. The same for any number of
// threads.
[[nodiscard]] double farthest_vertex(const SurfaceView& from, const SurfaceTree& to, unsigned threads);

// A face of which it is not known whether all of it is near, and a distance that none of its points exceeds.
struct DoubtfulFace {
  std::uint32_t face = no_id;
  double bound = std::numeric_limits<double>::infinity();
};

// Raises `limit` (> 0) in steps of a tenth until no point of the doubtful faces is farther from the surface of the
// tree, as their bounds have it or as measured; ends at `most`, which no point exceeds.
[[nodiscard]] double limit_of(const SurfaceView& from, std::span<const DoubtfulFace> doubtful, const SurfaceTree& to,
                              double limit, double most);

}  // namespace occlod
