// Holds the full meshes of the objects, to be shown beside what is refined or compared with it.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <vector>

#include "objects.h"
#include "occlod/item_buffer.h"
#include "occlod/picture.h"
#include "occlod/view.h"

namespace occlod::viewer {

// Tells how far the depth of a picture is from that of the full meshes. Never changes.
struct DepthDifference {
  Image image;                       // in the colours of error_color(), and two for what only one of them shows
  double rms_px = 0.0;               // see PictureDistance::depth_rms_px
  double silhouette_mismatch = 0.0;  // see PictureDistance
};

class FullMesh {
 public:
  // Makes the triangles of meshes that it does not have yet, and forgets those of others. O(size).
  void set(std::shared_ptr<const Objects> objects);
  [[nodiscard]] const std::vector<Triangle>& triangles(std::size_t object) const;
  [[nodiscard]] std::size_t triangle_count() const;

  // Compares a picture of the same objects, drawn for this camera, pixel by pixel. The depth of the full meshes is kept
  // for the next picture from there. O(full triangles + pixels) for a new camera, else O(pixels).
  [[nodiscard]] std::shared_ptr<const DepthDifference> difference(const Camera& camera, const DepthBuffer& shown);

 private:
  std::shared_ptr<const Objects> objects_;
  std::map<std::shared_ptr<const ViewMesh>, std::vector<Triangle>> triangles_;
  Camera camera_;      // of depth_
  DepthBuffer depth_;  // empty: not drawn yet
};

}  // namespace occlod::viewer
