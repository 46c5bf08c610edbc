// The mesh that hides: the current cuts of all objects.
#pragma once

#include <span>
#include <vector>

#include "cut.h"
#include "occlod/refine/refiner.h"
#include "occlod/refine/visibility.h"

namespace occlod {

// Reuses its memory. Triangles do not share vertices, so that a part holds only what it needs of a hierarchy.
class Occluder {
 public:
  // `views` by object. The result is valid until the next call. O(n log n) for n triangles.
  std::span<const OccluderPart> build(std::span<Cut> cuts, std::span<const ObjectView> views, OccluderMode mode);

 private:
  struct Part {
    std::vector<Triangle> cut;  // by the hierarchy's vertices
    std::vector<glm::vec3> positions;
    std::vector<Triangle> triangles;
  };

  void find_errors(const Cut& cut);
  [[nodiscard]] float error_of(const Cut& cut, const Triangle& t) const;

  std::vector<Part> parts_;
  std::vector<OccluderPart> result_;
  std::vector<float> errors_;  // of one cut: base vertices, then the vertices of its applied splits in their order
  std::vector<SplitId> base_roots_;
};

}  // namespace occlod
