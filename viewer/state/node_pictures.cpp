#include "node_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "layered_texture.h"
#include "mesh/image_codec.h"
#include "node_image.h"
#include "occlod/base.h"
#include "occlod/node_store.h"
#include "standard_streams.h"

namespace occlod::viewer {
namespace {

std::string name_of(hlod::NodeId n) { return fmt::format("the image of node {}", n); }

int halved(int size, unsigned times) { return std::max(1, size >> times); }

Image reduced(Image image, unsigned halvings) {
  if (halvings == 0) return image;
  const int width = halved(image.width, halvings), height = halved(image.height, halvings);
  const TextureImage whole(std::move(image), {TextureWrap::clamp, TextureWrap::clamp, TextureOrigin::top_left});
  return resampled({glm::vec3(1.0F), &whole}, width, height, TextureOrigin::top_left);
}

// Returns how often images of these sizes are halved so that all together fit.
unsigned halvings_for(std::span<const ImageSize> sizes, std::size_t max_bytes) {
  constexpr unsigned most = 16;  // then each has a single pixel in one direction
  for (unsigned times = 0; times < most; ++times) {
    std::uint64_t bytes = 0;
    for (const ImageSize& size : sizes)
      bytes += sizeof(glm::u8vec4) * static_cast<std::uint64_t>(halved(size.width, times)) *
               static_cast<std::uint64_t>(halved(size.height, times));
    if (bytes <= max_bytes) return times;
  }
  return most;
}

}  // namespace

std::vector<std::shared_ptr<const Image>> NodePictures::of(std::span<const hlod::DrawnNode> draws,
                                                           std::span<const hlod::PlacedHlod> placed,
                                                           std::size_t max_bytes) {
  std::erase_if(known_, [](const auto& entry) { return entry.second.expired(); });
  for (const hlod::PlacedHlod& object : placed)
    if (const hlod::NodeStore* const store = object.hlod->store())
      max_bytes = std::min(max_bytes, store->stats().budget_bytes);
  std::map<std::pair<const hlod::Hlod*, hlod::NodeId>, ImageSize> shown;
  for (const hlod::DrawnNode& draw : draws) {
    const hlod::Hlod& hlod = *placed[draw.object].hlod;
    const std::pair node(&hlod, draw.node);
    if (draw.splits > 0 || !hlod.is_resident(draw.node) || hlod.mesh(draw.node).image.empty() || shown.contains(node) ||
        broken_.contains(node))
      continue;
    try {
      shown[node] = size_of_image(hlod.mesh(draw.node).image, name_of(draw.node));
    } catch (const Error& error) {
      tool::print_note(std::string(error.what()) + "; the node is drawn without");
      broken_.insert(node);
    }
  }
  std::vector<ImageSize> sizes;
  for (const auto& [node, size] : shown) sizes.push_back(size);
  const unsigned halvings = halvings_for(sizes, max_bytes);
  std::vector<std::shared_ptr<const Image>> result;
  for (const hlod::DrawnNode& draw : draws) {
    const hlod::Hlod* const hlod = placed[draw.object].hlod;
    const bool has_one = draw.splits == 0 && shown.contains({hlod, draw.node});
    result.push_back(has_one ? decoded({hlod, draw.node, halvings}) : nullptr);
  }
  return result;
}

std::shared_ptr<const Image> NodePictures::decoded(const Key& key) {
  const auto& [hlod, node, halvings] = key;
  std::weak_ptr<const Image>& known = known_[key];
  if (std::shared_ptr<const Image> image = known.lock()) return image;
  if (broken_.contains({hlod, node})) return nullptr;
  try {
    auto image = std::make_shared<const Image>(reduced(tool::image_of_node(hlod->mesh(node), name_of(node)), halvings));
    known = image;
    return image;
  } catch (const Error& error) {
    tool::print_note(std::string(error.what()) + "; the node is drawn without");
    broken_.insert({hlod, node});
    return nullptr;
  }
}

}  // namespace occlod::viewer
