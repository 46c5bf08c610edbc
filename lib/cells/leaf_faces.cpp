#include "cells/leaf_faces.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

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

// Corners are all over the memory: those of some faces are on their way to the caches before the first is looked at.
void LeafFaces::drawn(std::uint32_t object, const CellView& view, std::span<const FaceRef> hidden,
                      std::vector<Triangle>& drawn) {
  struct Face {
    FaceRef ref;
    Triangle corners{0};
  };
  std::array<Face, 64> ahead;
  std::size_t count = 0;
  const Hierarchy& hierarchy = *objects_[object].hierarchy;
  const auto look = [&] {
    for (const Face& face : std::span(ahead).first(count))
      if (!faces_away(object, view, face.corners)) drawn.push_back(wedges_of_face(hierarchy, face.ref, face.corners));
    count = 0;
  };
  drawn.clear();
  cuts_[object].for_each_active([&](const FaceRef& face, const Triangle& t) {
    while (!hidden.empty() && face_key(hidden.front()) < face_key(face)) hidden = hidden.subspan(1);
    if (!hidden.empty() && hidden.front() == face) return;
    for (int k = 0; k < 3; ++k) prefetch(&hierarchy.positions()[t[k]]);
    ahead[count++] = {face, t};
    if (count == ahead.size()) look();
  });
  look();
}

namespace {

// Adds `more` to what is in the order of its keys already. Takes least where `more` is as well, as the file has it.
template <typename Value, typename Key>
void merge(const std::vector<Value>& more, std::vector<Value>& into, const Key& key) {
  const std::size_t before = into.size();
  into.insert(into.end(), more.begin(), more.end());
  const std::span<Value> added = std::span(into).subspan(before);
  if (!std::ranges::is_sorted(added, {}, key)) std::ranges::sort(added, {}, key);
  std::ranges::inplace_merge(into, into.begin() + static_cast<std::ptrdiff_t>(before), {}, key);
}

}  // namespace

void PathCut::gather(std::uint32_t object, std::span<const CellAdditions* const> path, bool is_leaf) {
  applied.clear();
  hidden.clear();
  for (const CellAdditions* node : path) {
    const auto found = std::ranges::lower_bound(node->objects, object, {}, &ObjectAdditions::object);
    if (found == node->objects.end() || found->object != object) continue;
    merge(found->splits, applied, [](SplitId s) { return s; });
    if (is_leaf) merge(found->hidden, hidden, [](const FaceRef& face) { return face_key(face); });
  }
}

}  // namespace occlod
