// The mesh that hides: the current cuts of all objects.
#pragma once

#include <span>
#include <vector>

#include "cut/cut_set.h"
#include "occlod/refine/refiner.h"
#include "occlod/refine/visibility.h"
#include "queries/sheet_erosion.h"

namespace occlod {

// Reuses its memory. As they are, the parts are triangles of the hierarchy's own vertices, in no order; without those
// that show their backs, except of two-sided objects.
class Occluder {
 public:
  // `cuts` and `views` by object. The result is valid until the next call. O(n) for n
  // triangles; O(n log n) where they are moved back.
  std::span<const OccluderPart> build(std::span<const RefineObject> objects, CutSet& cuts,
                                      std::span<const ObjectView> views, OccluderMode mode);

 private:
  struct Part {
    std::vector<Triangle> cut;         // before it is moved back, by the hierarchy's vertices
    std::vector<glm::vec3> positions;  // of what is moved back
    std::vector<Triangle> triangles;
  };

  void find_errors(const Cut& cut);
  void find_faces(const Cut& cut, std::span<const Triangle> triangles, bool two_sided, const glm::vec3& eye);
  void add_moved_back(const Cut& cut, const glm::vec3& eye, Part& part) const;
  [[nodiscard]] float error_of(const Cut& cut, const Triangle& t) const;

  std::vector<Part> parts_;
  std::vector<OccluderPart> result_;
  std::vector<float> errors_;  // of one cut: base vertices, then the vertices of its applied splits in their order
  std::vector<SplitId> base_roots_;
  std::vector<SheetFace> faces_;  // of one cut: those that are moved back
  SheetErosion erosion_;
};

}  // namespace occlod
