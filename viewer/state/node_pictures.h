// Decodes the images that nodes of HLODs have of their own.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "occlod/hlod.h"
#include "occlod/picture.h"
#include "occlod/traverser.h"

namespace occlod::viewer {

// What all images of one call take at most where a store of meshes allows no less: as the images of a model's
// materials.
inline constexpr std::size_t node_picture_bytes = std::size_t{256} << 20U;

// Images live as long as someone shows them, and are decoded once while they do.
class NodePictures {
 public:
  // Returns the image of each draw's node; null where it has none, where the draw is a cut, and for a mesh that has
  // left its store. Where all together would take more than `max_bytes`, 4 a pixel, or more than the meshes of a store
  // may, each is halved as often. One that cannot be decoded is left out with a note, once. O(pixels that are new).
  [[nodiscard]] std::vector<std::shared_ptr<const Image>> of(std::span<const hlod::DrawnNode> draws,
                                                             std::span<const hlod::PlacedHlod> placed,
                                                             std::size_t max_bytes = node_picture_bytes);

 private:
  using Key = std::tuple<const hlod::Hlod*, hlod::NodeId, unsigned>;  // and how often its image was halved

  [[nodiscard]] std::shared_ptr<const Image> decoded(const Key& key);

  std::map<Key, std::weak_ptr<const Image>> known_;
  std::set<std::pair<const hlod::Hlod*, hlod::NodeId>> broken_;
};

}  // namespace occlod::viewer
