#include "occlod/hlod.h"

#include <cassert>
#include <string>
#include <utility>

#include "hlod/store/hlod_data.h"
#include "occlod/base.h"

namespace occlod::hlod {
namespace {

template <typename T>
std::vector<T> to_vector(std::span<const T> values) {
  return {values.begin(), values.end()};
}

template <typename T>
std::span<const T> array_at(const std::byte* bytes, std::size_t count) {
  return {reinterpret_cast<const T*>(bytes), count};
}

}  // namespace

VertexLayout::VertexLayout(std::size_t vertices, const VertexArrays& arrays) {
  normals = vertices * sizeof(glm::vec3);
  colors = normals + (arrays.normals ? vertices * sizeof(glm::vec3) : 0);
  texture_coordinates = colors + (arrays.colors ? vertices * sizeof(glm::u8vec4) : 0);
  materials = texture_coordinates + (arrays.texture_coordinates ? vertices * sizeof(glm::vec2) : 0);
  end = materials + (arrays.materials ? vertices * sizeof(MaterialId) : 0);
}

MeshLayout::MeshLayout(const Node& node, const VertexArrays& arrays) : VertexLayout(node.vertices, arrays) {
  indices = end;
  merged_into = indices + 3 * std::size_t{node.triangles} * sizeof(std::uint16_t);
  bytes = merged_into + std::size_t{node.vertices} * sizeof(std::uint16_t);
}

SplitsLayout::SplitsLayout(const NodeWithin& within, const VertexArrays& arrays)
    : VertexLayout(std::size_t{within.bare} + within.splits, arrays) {
  errors = (end + alignof(float) - 1) / alignof(float) * alignof(float);
  indices = errors + within.splits * sizeof(float);
  parents = indices + 3 * std::size_t{within.triangles} * sizeof(std::uint16_t);
  bytes = parents + within.splits * sizeof(std::uint16_t);
}

HlodView view_of(const HlodData& data) {
  return {data.nodes,
          data.patches,
          data.children,
          data.roots,
          data.levels,
          data.meshes,
          data.box,
          data.input_triangle_count,
          data.grouping,
          data.borders,
          data.node_triangles,
          data.has_normals,
          data.has_colors,
          data.within,
          data.splits,
          data.has_texture_coordinates,
          data.has_materials,
          data.has_seams,
          data.materials,
          data.textures,
          data.texture_origin,
          data.lattice_step,
          data.origin,
          data.up,
          data.node_images,
          data.images,
          data.image_materials,
          view_of(data.features)};
}

Hlod make_hlod(HlodData data) {
  const auto owned = std::make_shared<const HlodData>(std::move(data));
  return {view_of(*owned), owned};
}

HlodData copy_data(const Hlod& hlod) {
  const HlodView& view = hlod.data();
  return {to_vector(view.nodes),
          to_vector(view.patches),
          to_vector(view.children),
          to_vector(view.roots),
          to_vector(view.levels),
          {view.meshes.begin(), view.meshes.end()},
          view.box,
          view.input_triangle_count,
          view.grouping,
          view.borders,
          view.node_triangles,
          view.has_normals,
          view.has_colors,
          to_vector(view.within),
          {view.splits.begin(), view.splits.end()},
          view.has_texture_coordinates,
          view.has_materials,
          view.has_seams,
          to_vector(view.materials),
          to_vector(view.textures),
          view.texture_origin,
          view.lattice_step,
          view.origin,
          view.up,
          to_vector(view.node_images),
          {view.images.begin(), view.images.end()},
          to_vector(view.image_materials),
          copy_of(view.features)};
}

Hlod guarded_hlod(const HlodView& view, std::shared_ptr<const void> owner, std::shared_ptr<NodeGuard> guard) {
  Hlod hlod(view, std::move(owner));
  hlod.checked_ = guard->checked();
  hlod.within_checked_ = guard->within_checked();
  hlod.guard_ = std::move(guard);
  return hlod;
}

NodeMesh mesh_at(const HlodView& view, NodeId n, const std::byte* bytes, const std::byte* image) noexcept {
  const Node& node = view.nodes[n];
  const MeshLayout layout(node, arrays_of(view));
  const std::size_t vertices = node.vertices;
  const std::size_t image_bytes = image_bytes_of(view, n), coordinates = vertices * sizeof(glm::u16vec2);
  return {array_at<glm::vec3>(bytes, vertices),
          array_at<glm::vec3>(bytes + layout.normals, view.has_normals ? vertices : 0),
          array_at<glm::u8vec4>(bytes + layout.colors, view.has_colors ? vertices : 0),
          array_at<std::uint16_t>(bytes + layout.indices, 3 * std::size_t{node.triangles}),
          array_at<std::uint16_t>(bytes + layout.merged_into, vertices),
          array_at<glm::vec2>(bytes + layout.texture_coordinates, view.has_texture_coordinates ? vertices : 0),
          array_at<MaterialId>(bytes + layout.materials, view.has_materials ? vertices : 0),
          image_bytes > 0 ? array_at<std::uint8_t>(image + coordinates, image_bytes - coordinates)
                          : std::span<const std::uint8_t>(),
          array_at<glm::u16vec2>(image, image_bytes > 0 ? vertices : 0)};
}

Hlod::Hlod(const HlodView& view, std::shared_ptr<const void> owner) : view_(view), owner_(std::move(owner)) {}

void Hlod::check_mesh(NodeId n) const {
  if (!is_resident(n))
    throw Error({"HLOD", "node " + std::to_string(n), "is not in memory: meshes come and go in a cache",
                 "open the file without a cache"});
  guard_->check(n);
}

void Hlod::check_within(NodeId n) const { guard_->check_within(n); }

void Hlod::require_all() const {
  if (store_ != nullptr)
    throw Error({"HLOD", "", "has meshes that come and go in a cache", "open the file without a cache"});
  for (NodeId n = 0; n < node_count(); ++n) {
    require(n);
    require_within(n);
  }
}

NodeMesh Hlod::mesh(NodeId n) const noexcept {
  assert(is_resident(n));
  if (resident_ == nullptr)
    return mesh_at(view_, n, view_.meshes.data() + node(n).mesh,
                   view_.images.data() + (view_.node_images.empty() ? 0 : view_.node_images[n].place));
  return mesh_at(view_, n, resident_[n].get(), resident_[n].get() + padded_mesh_bytes(view_, n));
}

NodeSplits Hlod::within(NodeId n) const noexcept {
  const NodeWithin& within = view_.within[n];
  const SplitsLayout layout(within, arrays_of(view_));
  assert(within.place % mesh_alignment == 0 && within.place + layout.bytes <= view_.splits.size());
  const std::byte* const bytes = view_.splits.data() + within.place;
  const std::size_t vertices = std::size_t{within.bare} + within.splits;
  return {array_at<glm::vec3>(bytes, vertices),
          array_at<glm::vec3>(bytes + layout.normals, view_.has_normals ? vertices : 0),
          array_at<glm::u8vec4>(bytes + layout.colors, view_.has_colors ? vertices : 0),
          array_at<float>(bytes + layout.errors, within.splits),
          array_at<std::uint16_t>(bytes + layout.indices, 3 * std::size_t{within.triangles}),
          array_at<std::uint16_t>(bytes + layout.parents, within.splits),
          array_at<glm::vec2>(bytes + layout.texture_coordinates, view_.has_texture_coordinates ? vertices : 0),
          array_at<MaterialId>(bytes + layout.materials, view_.has_materials ? vertices : 0)};
}

std::size_t Hlod::bytes() const noexcept {
  return view_.nodes.size_bytes() + view_.patches.size_bytes() + view_.children.size_bytes() +
         view_.roots.size_bytes() + view_.levels.size_bytes() + view_.meshes.size_bytes() + view_.within.size_bytes() +
         view_.splits.size_bytes() + view_.node_images.size_bytes() + view_.images.size_bytes() +
         view_.features.runs.size_bytes() + view_.features.first_run.size_bytes();
}

}  // namespace occlod::hlod
