#include "hlod/draw/prefetch.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "occlod/core/error.h"
#include "occlod/hlod/node_store.h"

namespace occlod::hlod {
namespace {

constexpr std::size_t most_reached = 4096;  // nodes, of one object

}  // namespace

std::optional<View> view_ahead(const Camera& before, const View& now, int frames) {
  Camera camera = now.camera();
  const glm::dvec3 last = before.target - before.eye, sight = camera.target - camera.eye;
  const double length = glm::length(sight);
  const glm::dvec3 motion = camera.eye - before.eye, turn = sight / length - last / glm::length(last);
  if (frames == 0 || (motion == glm::dvec3(0.0) && turn == glm::dvec3(0.0))) return std::nullopt;
  camera.eye += static_cast<double>(frames) * motion;
  const glm::dvec3 turned = sight / length + static_cast<double>(frames) * turn;
  camera.target = camera.eye + length / glm::length(turned) * turned;
  try {
    return View(camera);
  } catch (const Error&) {
    return std::nullopt;
  }
}

void Prefetcher::run(std::span<const PlacedHlod> objects, const Frame& frame, const std::optional<View>& ahead,
                     const TraverseOptions& options) {
  for (const PlacedHlod& object : objects)
    if (object.hlod->store() != nullptr && ahead) look_ahead(object, *ahead, options);
  for (const DrawnNode& drawn : frame.draws) {
    const Hlod& hlod = *objects[drawn.object].hlod;
    if (hlod.store() == nullptr) continue;
    for (const Patch& patch : hlod.patches(drawn.node)) {
      if (patch.parent == no_id) continue;
      for (const NodeId sibling : hlod.children(patch.parent))
        if (!hlod.is_resident(sibling)) hlod.store()->prefetch(sibling);
    }
  }
}

// As vfc does, down to what is not there.
void Prefetcher::look_ahead(const PlacedHlod& object, const View& ahead, const TraverseOptions& options) {
  const Hlod& hlod = *object.hlod;
  if (marks_.size() < hlod.node_count()) marks_.resize(hlod.node_count(), false);
  const ObjectFrame view(ahead, object, options);
  reached_.assign(hlod.data().roots.begin(), hlod.data().roots.end());
  for (std::size_t i = 0; i < reached_.size() && reached_.size() < most_reached; ++i) {
    const NodeId n = reached_[i];
    const Node& node = hlod.node(n);
    if (!view.may_be_inside(node.box)) continue;
    hlod.store()->prefetch(n);
    const bool is_fine = options.tolerance_px > 0.0 && view.error_px(node) <= options.tolerance_px;
    if (is_fine || !hlod.is_resident(n)) continue;
    for (const NodeId child : hlod.children(n)) {
      if (marks_[child]) continue;
      marks_[child] = true;
      reached_.push_back(child);
    }
  }
  for (const NodeId n : reached_) marks_[n] = false;
}

}  // namespace occlod::hlod
