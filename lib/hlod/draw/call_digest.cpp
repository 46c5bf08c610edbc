#include "hlod/draw/call_digest.h"

#include <array>
#include <type_traits>

#include "mesh/section_file.h"

namespace occlod::hlod {

// Of types without padding, whose bytes are their value.
template <typename T>
void CallDigest::add_all(std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto bytes = std::as_bytes(values);
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

template <typename T>
void CallDigest::add(const T& value) {
  add_all(std::span(&value, 1));
}

std::uint64_t CallDigest::finish() {
  const std::uint64_t digest = sections::checksum_of(bytes_);
  bytes_.clear();
  return digest;
}

std::uint64_t CallDigest::of_frame(const View& view, std::span<const PlacedHlod> objects) {
  const Camera& camera = view.camera();
  for (const glm::dvec3& v : {camera.eye, camera.target, camera.up}) add(v);
  for (const double value : {camera.fov_y_deg, camera.near, camera.far, camera.orthographic_height.value_or(0.0)})
    add(value);
  add(std::array{camera.width, camera.height});
  for (const PlacedHlod& placed : objects) {
    const HlodView& hlod = placed.hlod->data();
    add(placed.object_to_world);
    add(std::array{std::uint64_t{placed.two_sided ? 1U : 0U}, std::uint64_t{hlod.nodes.size()},
                   hlod.input_triangle_count, std::uint64_t{hlod.meshes.size()}});
    add(hlod.box);
  }
  return finish();
}

std::uint64_t CallDigest::of_draw(const NodeDraw& draw) {
  add(std::array{draw.object, draw.node, draw.splits, static_cast<std::uint32_t>(draw.ranges.size())});
  add_all(draw.ranges);
  add_all(draw.cut);
  return finish();
}

std::uint64_t CallDigest::of_boxes(std::span<const BoxRef> boxes) {
  add_all(boxes);
  return finish();
}

std::uint64_t CallDigest::of_number(std::uint64_t number) {
  add(number);
  return finish();
}

}  // namespace occlod::hlod
