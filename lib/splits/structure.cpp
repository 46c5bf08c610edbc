#include "splits/structure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "occlod/build_hierarchy.h"
#include "splits/star.h"
#include "splits/star_record.h"

namespace occlod {
namespace {

using Problem = std::optional<std::string>;

Problem check_sizes(const HierarchyView& d) {
  if (d.nodes.empty()) return "there is no sentinel split";
  const std::size_t splits = d.nodes.size() - 1;
  if (d.extra_wedges.size() > d.positions.size() || vertex_count(d) <= splits)
    return "there are more splits than vertices to split";
  if (d.positions.size() >= no_id || d.stars.size() >= no_id) return "there are more than 2^32 - 2 vertices or words";
  if (!d.normals.empty() && d.normals.size() != d.positions.size())
    return fmt::format("there are {} normals, not {}", d.normals.size(), d.positions.size());
  if (!d.colors.empty() && d.colors.size() != d.positions.size())
    return fmt::format("there are {} colors, not {}", d.colors.size(), d.positions.size());
  if (!d.texture_coordinates.empty() && d.texture_coordinates.size() != d.positions.size())
    return fmt::format("there are {} texture coordinates, not {}", d.texture_coordinates.size(), d.positions.size());
  if (!d.wedge_materials.empty() && d.wedge_materials.size() != d.positions.size())
    return fmt::format("there are {} materials of wedges, not {}", d.wedge_materials.size(), d.positions.size());
  if (!d.attribute_errors.empty() && d.attribute_errors.size() != splits)
    return fmt::format("there are {} errors of attributes, not {}", d.attribute_errors.size(), splits);
  const bool has_seams = !d.extra_wedges.empty();
  if (d.corner_starts.size() != (has_seams ? splits + 1 : 0) ||
      d.base_corners.size() != (has_seams ? d.base_faces.size() : 0) || (!has_seams && !d.corners.empty()))
    return "the wedges of the corners do not fit the faces";
  if (d.base_faces.size() > d.input_triangle_count || d.input_triangle_count > d.face_count)
    return "the counts of faces do not fit together";
  return std::nullopt;
}

bool is_finite(const glm::vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

// Checks that the wedges lie at their vertex and have valid materials.
Problem check_wedges_of(const HierarchyView& d, VertexId vertex) {
  const auto has_material = [&](std::size_t w) {
    return d.wedge_materials.empty() || d.wedge_materials[w] < d.materials.size();
  };
  if (!has_material(vertex)) return fmt::format("vertex {} has a material that is not there", vertex);
  const WedgeRange extra = extra_wedges_of(d, vertex);
  for (WedgeId w = extra.first; w < extra.first + extra.count; ++w) {
    if (d.positions[w] != d.positions[vertex]) return fmt::format("an extra wedge of vertex {} lies elsewhere", vertex);
    if (!has_material(w)) return fmt::format("wedge {} has a material that is not there", w);
  }
  return std::nullopt;
}

// Checks the corner record of split s, whose star has been checked.
Problem check_split_corners(const HierarchyView& d, SplitId s, VertexId vertex) {
  const std::uint32_t begin = d.corner_starts[s], end = d.corner_starts[s + 1];
  if (begin > end || end > d.corners.size())
    return fmt::format("the wedges at the corners of split {} leave their list", s);
  const SplitStar star(d.stars.data() + d.nodes[s].star, vertex);
  return check_corners(star, d.corners.subspan(begin, end - begin), s, d.extra_wedges, vertex_count(d));
}

// Checks that extra wedges belong to existing vertices, ascend and lie at their positions, that faces of the base mesh
// use wedges of their vertices, and that materials and textures exist.
Problem check_wedges(const HierarchyView& d) {
  const std::size_t vertices = vertex_count(d);
  VertexId last = 0;
  for (std::size_t i = 0; i < d.extra_wedges.size(); ++i) {
    const VertexId v = d.extra_wedges[i];
    if (v >= vertices || v < last) return fmt::format("extra wedge {} is out of order", i);
    last = v;
  }
  for (VertexId v = 0; v < vertices - (d.nodes.size() - 1); ++v)
    if (Problem p = check_wedges_of(d, v)) return p;
  for (std::size_t f = 0; f < d.base_corners.size(); ++f)
    for (int k = 0; k < 3; ++k)
      if (!is_wedge_of(d.base_corners[f][k], d.base_faces[f][k], d.extra_wedges, vertices))
        return fmt::format("base face {} has a wedge of another vertex", f);
  for (std::size_t m = 0; m < d.materials.size(); ++m)
    if (const TextureId texture = d.materials[m].texture_beyond(d.textures.size()); texture != no_texture)
      return fmt::format("material {} names texture {}, but there are {}", m, texture, d.textures.size());
  return std::nullopt;
}

// Returns the number of inserted faces. Reads only the header of the star, which need not have been checked yet.
std::uint32_t inserted_count_of(const HierarchyView& d, SplitId s) {
  constexpr std::size_t longest_header = 5;
  const std::size_t begin = d.nodes[s].star;
  if (begin >= d.stars.size()) return 0;
  const bool is_fan = (d.stars[begin] & SplitStar::other_bit) == 0;
  if (!is_fan && d.stars.size() - begin < longest_header) return 0;
  return SplitStar(d.stars.data() + begin, no_id).inserted_count();
}

// Checks that earlier splits insert the faces that split s removes. The star of s has been checked.
Problem check_removed_slots(const HierarchyView& d, SplitId s, VertexId vertex) {
  bool are_there = true;
  SplitStar(d.stars.data() + d.nodes[s].star, vertex).for_each_removed_ref([&](const FaceRef& face) {
    are_there = are_there && (face.split == no_id || face.slot < inserted_count_of(d, face.split));
  });
  return are_there ? Problem() : fmt::format("split {} removes a face that no split inserts", s);
}

Problem check_node(const HierarchyView& d, SplitId s) {
  const SplitNode& node = d.nodes[s];
  const std::size_t splits = d.nodes.size() - 1;
  for (const SplitId child : {node.child_u, node.child_v})
    if (child != no_id && (child <= s || child >= splits))
      return fmt::format("split {} has child {} out of order", s, child);
  if (node.parent != no_id && node.parent >= s) return fmt::format("split {} is above its parent in the forest", s);
  if (!is_finite(node.sphere.center) || !(node.sphere.radius >= 0.0F) || !std::isfinite(node.sphere.radius))
    return fmt::format("the sphere of split {} is no sphere", s);
  if (!(node.error >= 0.0F) || !(node.guaranteed_error >= 0.0F)) return fmt::format("split {} has an error below 0", s);
  const std::uint32_t end = d.nodes[s + 1].star;
  if (node.star > end || end > d.stars.size()) return fmt::format("the star of split {} leaves its list", s);
  const auto vertex = static_cast<VertexId>(vertex_count(d) - splits + s);
  if (!is_finite(d.positions[vertex])) return fmt::format("vertex {} is not finite", vertex);
  if (Problem p = check_wedges_of(d, vertex)) return p;
  if (Problem p = check_star(d.stars.subspan(node.star, end - node.star), s, vertex, d.base_faces.size())) return p;
  if (Problem p = check_removed_slots(d, s, vertex)) return p;
  return d.corner_starts.empty() ? std::nullopt : check_split_corners(d, s, vertex);
}

}  // namespace

WedgeRange extra_wedges_of(const HierarchyView& data, std::size_t first, std::size_t count) noexcept {
  const auto wedges = data.extra_wedges;
  const auto begin = std::lower_bound(wedges.begin(), wedges.end(), first);
  const auto end = std::lower_bound(begin, wedges.end(), first + count);
  return {static_cast<WedgeId>(vertex_count(data) + static_cast<std::size_t>(begin - wedges.begin())),
          static_cast<std::uint32_t>(end - begin)};
}

std::optional<std::string> check_base(const HierarchyView& d) {
  if (Problem p = check_sizes(d)) return p;
  const std::size_t base_vertices = vertex_count(d) - (d.nodes.size() - 1);
  const auto bad = std::find_if_not(d.positions.begin(),
                                    d.positions.begin() + static_cast<std::ptrdiff_t>(base_vertices), is_finite);
  if (bad != d.positions.begin() + static_cast<std::ptrdiff_t>(base_vertices))
    return fmt::format("vertex {} is not finite", bad - d.positions.begin());
  for (std::size_t f = 0; f < d.base_faces.size(); ++f)
    for (int k = 0; k < 3; ++k)
      if (d.base_faces[f][k] >= base_vertices)
        return fmt::format("base face {} has a corner that is not in the base mesh", f);
  if (Problem p = check_wedges(d)) return p;
  SplitId last = no_id;
  for (const SplitId root : d.roots) {
    if (root >= d.nodes.size() - 1) return fmt::format("root {} is not a split", root);
    if (last != no_id && root <= last) return fmt::format("root {} is out of order", root);
    last = root;
  }
  return std::nullopt;
}

std::optional<std::string> check_splits(const HierarchyView& d, SplitId first, SplitId end) {
  for (SplitId s = first; s < end; ++s)
    if (Problem p = check_node(d, s)) return p;
  return std::nullopt;
}

std::optional<std::string> check_structure(const HierarchyView& d) {
  if (Problem p = check_base(d)) return p;
  const auto splits = static_cast<SplitId>(d.nodes.size() - 1);
  if (Problem p = check_splits(d, 0, splits)) return p;
  if ((splits == 0 ? 0 : d.nodes[0].star) != 0 || d.nodes[splits].star != d.stars.size())
    return "the stars do not begin and end with their list";
  if (!d.corner_starts.empty() && (d.corner_starts[0] != 0 || d.corner_starts[splits] != d.corners.size()))
    return "the wedges of the corners do not begin and end with their list";
  // Checks that every split is a root or the child of the split that it names as its parent.
  std::size_t children = 0;
  for (SplitId s = 0; s < splits; ++s)
    for (const SplitId child : {d.nodes[s].child_u, d.nodes[s].child_v}) {
      if (child == no_id) continue;
      ++children;
      if (d.nodes[child].parent != s || d.nodes[s].child_u == d.nodes[s].child_v)
        return fmt::format("split {} is the child of split {}, but does not say so", child, s);
    }
  for (const SplitId root : d.roots)
    if (d.nodes[root].parent != no_id) return fmt::format("root {} has a parent", root);
  if (children + d.roots.size() != splits) return "some split is not in the forest";
  return std::nullopt;
}

}  // namespace occlod
