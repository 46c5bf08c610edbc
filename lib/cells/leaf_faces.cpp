#include "cells/leaf_faces.h"

#include <algorithm>

#include "occlod/build_hierarchy.h"
#include "splits/star.h"

namespace occlod {

LeafFaces::LeafFaces(std::span<const RefineObject> objects) : objects_(objects.begin(), objects.end()) {
  for (const RefineObject& object : objects) cuts_.emplace_back(*object.hierarchy);
}

void LeafFaces::set(std::uint32_t object, std::span<const SplitId> applied) { cuts_[object].set(applied); }

bool LeafFaces::faces_away(std::uint32_t object, const CellView& view, const Triangle& t) const {
  if (objects_[object].two_sided) return false;
  const std::span<const glm::vec3> positions = objects_[object].hierarchy->positions();
  return view.faces_away(positions[t.x], positions[t.y], positions[t.z]);
}

void LeafFaces::classify(std::uint32_t object, const CellView& view, std::span<const Triangle> drawn,
                         std::vector<FaceRef>& drawn_faces, std::vector<FaceRef>& hidden_faces) {
  drawn_faces.clear();
  hidden_faces.clear();
  cuts_[object].for_each_active([&](const FaceRef& face, const Triangle& t) {
    if (!drawn.empty() && drawn.front() == wedges_of_face(*objects_[object].hierarchy, face, t)) {
      drawn = drawn.subspan(1);
      drawn_faces.push_back(face);
    } else if (!faces_away(object, view, t)) {
      hidden_faces.push_back(face);
    }
  });
}

void LeafFaces::drawn(std::uint32_t object, const CellView& view, std::span<const FaceRef> hidden,
                      std::vector<Triangle>& drawn) {
  drawn.clear();
  cuts_[object].for_each_active([&](const FaceRef& face, const Triangle& t) {
    while (!hidden.empty() && face_key(hidden.front()) < face_key(face)) hidden = hidden.subspan(1);
    const bool is_hidden = !hidden.empty() && hidden.front() == face;
    if (!is_hidden && !faces_away(object, view, t))
      drawn.push_back(wedges_of_face(*objects_[object].hierarchy, face, t));
  });
}

void PathCut::gather(std::uint32_t object, std::span<const CellAdditions* const> path, bool is_leaf) {
  applied.clear();
  hidden.clear();
  for (const CellAdditions* node : path) {
    const auto found = std::ranges::lower_bound(node->objects, object, {}, &ObjectAdditions::object);
    if (found == node->objects.end() || found->object != object) continue;
    applied.insert(applied.end(), found->splits.begin(), found->splits.end());
    if (is_leaf) hidden.insert(hidden.end(), found->hidden.begin(), found->hidden.end());
  }
  std::ranges::sort(applied);
  std::ranges::sort(hidden, {}, face_key);
}

}  // namespace occlod
