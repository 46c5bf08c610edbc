// The mesh that hides: the current cuts of all objects.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "refine/cut_set.h"
#include "splits/surface_motion.h"
#include "occlod/refine/refiner.h"
#include "occlod/refine/visibility.h"
#include "refine/tile_occluder.h"

namespace occlod {

// Reuses its memory. In mode paper, the parts are triangles of the hierarchy's own vertices, in no order; without those
// that show their backs, except of two-sided objects. In mode conservative, they are squares on tiles of the image.
class Occluder {
 public:
  // What conservative mode leaves out, for tests: then the result is not what it promises.
  struct Without {
    bool motion = false;  // guaranteed errors in place of how far faces have moved
    TileOccluder::Without tiles;
  };

  Occluder() = default;
  explicit Occluder(const Without& without) : without_(without) {}

  // `cuts` and `views`, of `view`, by object. The result is valid until the next call. O(n) for n triangles; in mode
  // conservative O(n log n + tiles touched), and once for each hierarchy the time of motion_of().
  std::span<const OccluderPart> build(std::span<const RefineObject> objects, CutSet& cuts, const View& view,
                                      std::span<const ObjectView> views, OccluderMode mode);

 private:
  struct Part {
    std::vector<glm::vec3> positions;  // of squares; conservative only
    std::vector<Triangle> triangles;
  };
  // A vertex of a cut: the first split of its chain that is not applied.
  struct CutVertex {
    SplitId first_left = no_id;
    bool is_marked = false;
  };

  void build_conservative(std::span<const RefineObject> objects, CutSet& cuts, const View& view,
                          std::span<const ObjectView> views);
  void hold_motions(const CutSet& cuts);
  void find_vertices(const Cut& cut, const SurfaceMotion& motion);
  void add_vertex(const Cut& cut, const SurfaceMotion& motion, VertexId v, SplitId first);
  void find_faces(const Cut& cut, const SurfaceMotion& motion);
  [[nodiscard]] const CutVertex& vertex(const Cut& cut, VertexId v) const;

  Without without_;
  std::vector<Part> parts_;
  std::vector<OccluderPart> result_;
  std::vector<std::shared_ptr<const SurfaceMotion>> motions_;  // by object
  std::vector<const glm::vec3*> held_;                         // whose they are, by their positions
  std::vector<CutVertex> vertices_;  // of one cut: of the base, then of its applied splits in their order
  std::vector<SplitId> base_roots_;
  std::vector<MovedFace> faces_;  // of one cut
  TileOccluder tiles_;
};

}  // namespace occlod
