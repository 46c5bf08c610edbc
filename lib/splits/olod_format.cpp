#include "splits/olod_format.h"

#include <xxhash.h>

#include <algorithm>
#include <memory>

#include "splits/split_guard.h"
#include "splits/structure.h"

namespace occlod::olod {
namespace {

class Digest {
 public:
  Digest() { XXH3_64bits_reset(&state_); }
  template <typename T>
  void add(std::span<const T> values) {
    XXH3_64bits_update(&state_, values.data(), values.size_bytes());
  }
  // Attributes may be absent.
  template <typename T>
  void add(std::span<const T> values, std::size_t first, std::size_t count) {
    if (!values.empty()) add(values.subspan(first, count));
  }
  [[nodiscard]] std::uint64_t value() const { return XXH3_64bits_digest(&state_); }

 private:
  XXH3_state_t state_;
};

void add_wedges(const HierarchyView& view, std::size_t first, std::size_t count, Digest& digest) {
  digest.add(view.positions, first, count);
  digest.add(view.normals, first, count);
  digest.add(view.colors, first, count);
  digest.add(view.texture_coordinates, first, count);
  digest.add(view.wedge_materials, first, count);
}

std::size_t split_count(const HierarchyView& view) { return view.nodes.size() - 1; }

// Vertices and their extra wedges, which ascend with them.
void add_vertices(const HierarchyView& view, std::size_t first, std::size_t count, Digest& digest) {
  add_wedges(view, first, count, digest);
  const WedgeRange extra = extra_wedges_of(view, first, count);
  if (extra.count > 0) add_wedges(view, extra.first, extra.count, digest);
}

}  // namespace

bool needs_wedges(const HierarchyView& view) {
  return !view.extra_wedges.empty() || !view.texture_coordinates.empty() || !view.wedge_materials.empty() ||
         !view.materials.empty() || !view.textures.empty();
}

std::uint64_t digest_of_base(const HierarchyView& view) {
  Digest digest;
  add_vertices(view, 0, vertex_count(view) - split_count(view), digest);
  return digest.value();
}

BlockRange range_of_block(const HierarchyView& view, std::size_t block) {
  const std::size_t first = block * SplitGuard::block_size;
  return {first, std::min(first + SplitGuard::block_size, split_count(view))};
}

std::uint64_t digest_of_block(const HierarchyView& view, std::size_t block) {
  const auto [first, end] = range_of_block(view, block);
  Digest digest;
  digest.add(view.nodes, first, end - first);
  const std::size_t star = view.nodes[first].star;
  digest.add(view.stars, star, view.nodes[end].star - star);
  if (!view.corner_starts.empty()) {
    digest.add(view.corner_starts, first, end + 1 - first);
    const std::size_t corner = view.corner_starts[first];
    digest.add(view.corners.subspan(corner, view.corner_starts[end] - corner));
  }
  digest.add(view.attribute_errors, first, end - first);
  add_vertices(view, vertex_count(view) - split_count(view) + first, end - first, digest);
  return digest.value();
}

}  // namespace occlod::olod
