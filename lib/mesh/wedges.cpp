#include "mesh/wedges.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "base/arithmetic.h"
#include "base/option_checker.h"
#include "occlod/mesh.h"

namespace occlod {
namespace {

// The attributes that a corner may have: those of a vertex as read, and the kind of its triangle.
struct Attributes {
  VertexId vertex;     // the welded vertex of the corner
  VertexId source;     // the vertex as read
  std::uint32_t kind;  // triangles of different kinds share no wedge: the material, or material and feature
};

// A hash table of wedges beyond the first of their vertices, by vertex and attributes: open addressing, at most half
// full.
class ExtraWedges {
 public:
  explicit ExtraWedges(const TriangleMesh& mesh) : mesh_(mesh), slots_(64, no_id) {}

  // Returns the number of the wedge with these attributes, in the order in which they were first requested.
  std::uint32_t find_or_add(const Attributes& wanted) {
    if (2 * wedges_.size() >= slots_.size()) grow();
    std::size_t slot = hash_of(wanted) & (slots_.size() - 1);
    while (slots_[slot] != no_id && !is_same(wedges_[slots_[slot]], wanted)) slot = (slot + 1) & (slots_.size() - 1);
    if (slots_[slot] == no_id) {
      slots_[slot] = static_cast<std::uint32_t>(wedges_.size());
      wedges_.push_back(wanted);
    }
    return slots_[slot];
  }

  [[nodiscard]] bool have_equal_attributes(VertexId a, VertexId b) const {
    if (a == b) return true;
    return (mesh_.normals.empty() || mesh_.normals[a] == mesh_.normals[b]) &&
           (mesh_.colors.empty() || mesh_.colors[a] == mesh_.colors[b]) &&
           (mesh_.texture_coordinates.empty() || mesh_.texture_coordinates[a] == mesh_.texture_coordinates[b]);
  }
  [[nodiscard]] const std::vector<Attributes>& wedges() const { return wedges_; }

 private:
  [[nodiscard]] bool is_same(const Attributes& a, const Attributes& b) const {
    return a.vertex == b.vertex && a.kind == b.kind && have_equal_attributes(a.source, b.source);
  }

  // Returns the same bits for -0 as for +0.
  static std::uint64_t bits(float a, float b) {
    return std::bit_cast<std::uint32_t>(a + 0.0F) | std::uint64_t{std::bit_cast<std::uint32_t>(b + 0.0F)} << 32;
  }

  [[nodiscard]] std::size_t hash_of(const Attributes& of) const {
    std::uint64_t hash = scatter(of.vertex | std::uint64_t{of.kind} << 32);
    if (!mesh_.normals.empty()) {
      const glm::vec3& n = mesh_.normals[of.source];
      hash = scatter(scatter(hash + bits(n.x, n.y)) + bits(n.z, 0.0F));
    }
    if (!mesh_.colors.empty()) hash = scatter(hash + std::bit_cast<std::uint32_t>(mesh_.colors[of.source]));
    if (!mesh_.texture_coordinates.empty()) {
      const glm::vec2& t = mesh_.texture_coordinates[of.source];
      hash = scatter(hash + bits(t.x, t.y));
    }
    return hash;
  }

  void grow() {
    slots_.assign(2 * slots_.size(), no_id);
    for (std::uint32_t i = 0; i < wedges_.size(); ++i) {
      std::size_t slot = hash_of(wedges_[i]) & (slots_.size() - 1);
      while (slots_[slot] != no_id) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = i;
    }
  }

  const TriangleMesh& mesh_;
  std::vector<Attributes> wedges_;
  std::vector<std::uint32_t> slots_;  // indices into wedges_
};

class WedgeFormer {
 public:
  // `kinds` has one for each triangle; empty: the material decides.
  WedgeFormer(TriangleMesh& mesh, std::vector<Triangle> corners, std::span<const std::uint32_t> kinds)
      : mesh_(mesh), corners_(std::move(corners)), kinds_(kinds), first_(mesh.positions.size(), no_id), extra_(mesh) {}

  bool run() && {
    if (!mesh_.triangle_materials.empty() || !kinds_.empty()) first_kind_.resize(first_.size());
    const auto vertices_read = static_cast<std::uint64_t>(first_.size());
    for (std::size_t t = 0; t < corners_.size(); ++t) {
      for (int k = 0; k < 3; ++k) find_wedge(mesh_.triangles[t][k], corners_[t][k], kind_of(t));
      if (vertices_read + extra_.wedges().size() >= no_id) return false;
    }
    number_vertices();
    number_extra_wedges();
    move_arrays();
    return true;
  }

 private:
  [[nodiscard]] std::uint32_t kind_of(std::size_t t) const {
    return kinds_.empty() ? std::uint32_t{mesh_.material_of(t)} : kinds_[t];
  }

  // Replaces the vertex as read at a corner by its wedge: the vertex itself for its first wedge, else a number from
  // extra_.
  void find_wedge(VertexId vertex, VertexId& corner, std::uint32_t kind) {
    VertexId& first = first_[vertex];
    if (first == no_id) {
      first = corner;
      if (!first_kind_.empty()) first_kind_[vertex] = kind;
    }
    const bool same_kind = first_kind_.empty() || first_kind_[vertex] == kind;
    if (same_kind && extra_.have_equal_attributes(first, corner))
      corner = vertex;
    else
      corner = static_cast<VertexId>(first_.size()) + extra_.find_or_add({vertex, corner, kind});
  }

  void number_vertices() {
    new_id_.resize(first_.size());
    for (std::size_t v = 0; v < first_.size(); ++v) {
      if (first_[v] != no_id) new_id_[v] = vertex_count_++;
    }
  }

  // Sorts the extra wedges by vertex with a stable counting sort.
  void number_extra_wedges() {
    const std::vector<Attributes>& wedges = extra_.wedges();
    if (wedges.empty()) return;
    std::vector<std::uint32_t> next(vertex_count_ + std::size_t{1}, 0);
    for (const Attributes& wedge : wedges) ++next[new_id_[wedge.vertex] + 1];
    for (std::size_t v = 1; v < next.size(); ++v) next[v] += next[v - 1];
    new_extra_id_.resize(wedges.size());
    for (std::size_t i = 0; i < wedges.size(); ++i)
      new_extra_id_[i] = vertex_count_ + next[new_id_[wedges[i].vertex]]++;
  }

  void move_arrays() {
    std::vector<VertexId> sources(vertex_count_ + new_extra_id_.size());
    for (std::size_t v = 0; v < first_.size(); ++v) {
      if (first_[v] != no_id) sources[new_id_[v]] = first_[v];
    }
    for (std::size_t i = 0; i < new_extra_id_.size(); ++i) sources[new_extra_id_[i]] = extra_.wedges()[i].source;
    gather(mesh_.normals, sources);
    gather(mesh_.colors, sources);
    gather(mesh_.texture_coordinates, sources);
    // All wedges of a vertex get the same bits as position, even when -0 was welded to +0.
    for (std::size_t v = 0; v < first_.size(); ++v) {
      if (first_[v] != no_id) sources[new_id_[v]] = static_cast<VertexId>(v);
    }
    for (std::size_t i = 0; i < new_extra_id_.size(); ++i) sources[new_extra_id_[i]] = extra_.wedges()[i].vertex;
    gather(mesh_.positions, sources);
    move_corners();
  }

  void move_corners() {
    const auto vertices_read = static_cast<VertexId>(first_.size());
    for (Triangle& t : mesh_.triangles) t = {new_id_[t.x], new_id_[t.y], new_id_[t.z]};
    mesh_.extra_wedges.resize(new_extra_id_.size());
    if (new_extra_id_.empty()) return;
    for (std::size_t i = 0; i < new_extra_id_.size(); ++i)
      mesh_.extra_wedges[new_extra_id_[i] - vertex_count_] = new_id_[extra_.wedges()[i].vertex];
    for (Triangle& t : corners_) {
      for (int k = 0; k < 3; ++k) t[k] = t[k] < vertices_read ? new_id_[t[k]] : new_extra_id_[t[k] - vertices_read];
    }
    mesh_.corners = std::move(corners_);
  }

  template <class T>
  static void gather(std::vector<T>& values, const std::vector<VertexId>& sources) {
    if (values.empty()) return;
    std::vector<T> gathered;
    gathered.reserve(sources.size());
    for (const VertexId source : sources) gathered.push_back(values[source]);
    values = std::move(gathered);
  }

  TriangleMesh& mesh_;
  std::vector<Triangle> corners_;
  std::span<const std::uint32_t> kinds_;
  std::vector<VertexId> first_;  // by vertex: the vertex as read whose attributes its first wedge has; no_id when
                                 // unused
  std::vector<std::uint32_t> first_kind_;  // by vertex; empty when all triangles have one kind
  ExtraWedges extra_;
  std::vector<VertexId> new_id_;       // by vertex
  std::vector<WedgeId> new_extra_id_;  // by number in extra_
  VertexId vertex_count_ = 0;
};

}  // namespace

bool form_wedges(TriangleMesh& mesh, std::vector<Triangle> read_corners) {
  return WedgeFormer(mesh, std::move(read_corners), {}).run();
}

TriangleMesh part_features(TriangleMesh mesh) {
  if (mesh.triangle_features.empty()) return mesh;
  using Kind = std::pair<MaterialId, FeatureId>;
  std::vector<Kind> all;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
    if (const Kind kind{mesh.material_of(t), mesh.triangle_features[t]}; all.empty() || all.back() != kind)
      all.push_back(kind);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  std::vector<std::uint32_t> kinds;
  kinds.reserve(mesh.triangle_count());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const auto found = std::lower_bound(all.begin(), all.end(), Kind{mesh.material_of(t), mesh.triangle_features[t]});
    kinds.push_back(static_cast<std::uint32_t>(found - all.begin()));
  }
  std::vector<Triangle> corners = mesh.corners.empty() ? mesh.triangles : std::move(mesh.corners);
  mesh.corners.clear();
  mesh.extra_wedges.clear();
  if (!WedgeFormer(mesh, std::move(corners), kinds).run())
    throw Error({"mesh", "", "has too many vertices", "split it into parts"});
  return mesh;
}

std::vector<FeatureId> wedge_features(const TriangleMesh& mesh) {
  std::vector<FeatureId> features(mesh.triangle_features.empty() ? 0 : mesh.wedge_count(), 0);
  for (std::size_t t = 0; t < mesh.triangle_features.size(); ++t)
    for (int k = 0; k < 3; ++k) features[mesh.wedge_triangles()[t][k]] = mesh.triangle_features[t];
  return features;
}

namespace {

// Calls merge(vertex, first, last) for each vertex with more than one wedge; its extra wedges are [first, last) of
// extra_wedges.
template <class Merge>
void for_each_seam_vertex(const TriangleMesh& mesh, Merge merge) {
  const std::vector<VertexId>& extra = mesh.extra_wedges;
  for (std::size_t first = 0, last = 0; first < extra.size(); first = last) {
    while (last < extra.size() && extra[last] == extra[first]) ++last;
    merge(extra[first], first, last);
  }
}

void merge_normals(const TriangleMesh& mesh, std::vector<glm::vec3>& normals) {
  const std::size_t vertices = mesh.vertex_count();
  for_each_seam_vertex(mesh, [&](VertexId v, std::size_t first, std::size_t last) {
    glm::dvec3 sum(normals[v]);
    for (std::size_t i = first; i < last; ++i) sum += glm::dvec3(mesh.normals[vertices + i]);
    const double length = glm::length(sum);
    if (length > 0.0) normals[v] = glm::vec3(sum / length);
  });
}

void merge_colors(const TriangleMesh& mesh, std::vector<glm::u8vec4>& colors) {
  const std::size_t vertices = mesh.vertex_count();
  for_each_seam_vertex(mesh, [&](VertexId v, std::size_t first, std::size_t last) {
    glm::u64vec4 sum(colors[v]);
    for (std::size_t i = first; i < last; ++i) sum += glm::u64vec4(mesh.colors[vertices + i]);
    const std::uint64_t count = 1 + last - first;
    colors[v] = glm::u8vec4((sum + count / 2) / count);
  });
}

template <class T>
std::vector<T> first_ones(const std::vector<T>& values, std::size_t count) {
  return values.empty() ? values : std::vector<T>(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(count));
}

}  // namespace

TriangleMesh merge_wedges(const TriangleMesh& mesh) {
  TriangleMesh merged;
  merged.positions = first_ones(mesh.positions, mesh.vertex_count());
  merged.normals = first_ones(mesh.normals, mesh.vertex_count());
  merged.colors = first_ones(mesh.colors, mesh.vertex_count());
  merged.triangles = mesh.triangles;
  merged.origin = mesh.origin;
  merged.triangle_features = mesh.triangle_features;
  merged.feature_names = mesh.feature_names;
  if (!mesh.normals.empty()) merge_normals(mesh, merged.normals);
  if (!mesh.colors.empty()) merge_colors(mesh, merged.colors);
  return merged;
}

namespace {

// One corner of the star of a vertex.
struct StarCorner {
  std::uint32_t triangle;
  int corner;  // 0, 1 or 2
};

// The corners at each vertex, in ascending order of triangles.
class Stars {
 public:
  explicit Stars(const TriangleMesh& mesh) : offsets_(mesh.vertex_count() + 1) {
    for (const Triangle& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) ++offsets_[t[k] + std::size_t{1}];
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    corners_.resize(3 * mesh.triangle_count());
    std::vector<std::size_t> next(offsets_.begin(), offsets_.end() - 1);
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t)
      for (int k = 0; k < 3; ++k) corners_[next[mesh.triangles[t][k]]++] = {static_cast<std::uint32_t>(t), k};
  }
  [[nodiscard]] const StarCorner* begin(VertexId v) const { return corners_.data() + offsets_[v]; }
  [[nodiscard]] std::size_t size(VertexId v) const { return offsets_[v + std::size_t{1}] - offsets_[v]; }

 private:
  std::vector<std::size_t> offsets_;
  std::vector<StarCorner> corners_;
};

class Creaser {
 public:
  Creaser(const TriangleMesh& mesh, double degrees)
      : mesh_(mesh), stars_(mesh), smooths_all_(degrees >= 180.0), min_cosine_(std::cos(degrees * radians) - slack) {
    areas_.reserve(mesh.triangle_count());
    for (const Triangle& t : mesh.triangles) {
      const glm::dvec3 a(mesh.positions[t.x]);
      areas_.push_back(glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a));
    }
  }

  TriangleMesh run() && {
    result_.triangles.resize(mesh_.triangle_count());
    for (VertexId v = 0; v < mesh_.vertex_count(); ++v) {
      group(v);
      take_groups(v);
    }
    result_.triangle_materials = mesh_.triangle_materials;
    result_.triangle_features = mesh_.triangle_features;
    result_.feature_names = mesh_.feature_names;
    result_.materials = mesh_.materials;
    result_.textures = mesh_.textures;
    result_.texture_origin = mesh_.texture_origin;
    result_.origin = mesh_.origin;
    result_.up = mesh_.up;
    return std::move(result_);
  }

 private:
  static constexpr double radians = 0.017453292519943295;
  static constexpr double slack = 1e-12;  // rounding error of cosines: triangles in one plane are smooth at 0 degrees

  // A triangle's use of an edge at the vertex.
  struct Spoke {
    VertexId rim;
    std::uint32_t slot;  // place of the triangle in the star
  };

  // Sets group_ for each slot of the star to the smallest slot with which it is joined.
  void group(VertexId v) {
    const std::size_t size = stars_.size(v);
    spokes_.clear();
    group_.resize(size);
    std::iota(group_.begin(), group_.end(), 0U);
    for (std::uint32_t slot = 0; slot < size; ++slot) {
      const auto [triangle, corner] = stars_.begin(v)[slot];
      const Triangle& t = mesh_.triangles[triangle];
      spokes_.push_back({t[(corner + 1) % 3], slot});
      spokes_.push_back({t[(corner + 2) % 3], slot});
    }
    std::sort(spokes_.begin(), spokes_.end(),
              [](const Spoke& a, const Spoke& b) { return std::pair(a.rim, a.slot) < std::pair(b.rim, b.slot); });
    for (std::size_t first = 0, last = 0; first < spokes_.size(); first = last) {
      while (last < spokes_.size() && spokes_[last].rim == spokes_[first].rim) ++last;
      if (last - first != 2) continue;
      const std::uint32_t a = spokes_[first].slot, b = spokes_[first + 1].slot;
      if (are_smooth(stars_.begin(v)[a].triangle, stars_.begin(v)[b].triangle)) join(a, b);
    }
    for (std::uint32_t slot = 0; slot < size; ++slot) group_[slot] = root(slot);
  }

  // True when two triangles are smoothed across their edge; a triangle without area has no angle and is smooth with
  // any.
  [[nodiscard]] bool are_smooth(std::uint32_t a, std::uint32_t b) const {
    const double lengths = glm::length(areas_[a]) * glm::length(areas_[b]);
    return smooths_all_ || !(lengths > 0.0) || glm::dot(areas_[a], areas_[b]) >= min_cosine_ * lengths;
  }

  std::uint32_t root(std::uint32_t slot) {
    while (group_[slot] != slot) slot = group_[slot] = group_[group_[slot]];
    return slot;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    group_[std::max(a, b)] = std::min(a, b);
  }

  // Makes a vertex of the result for each pair of a group and a wedge that meet at a corner; clean() turns them into
  // wedges.
  void take_groups(VertexId v) {
    const std::size_t size = stars_.size(v);
    sums_.assign(size, glm::dvec3(0.0));
    order_.clear();
    for (std::uint32_t slot = 0; slot < size; ++slot) {
      const auto [triangle, corner] = stars_.begin(v)[slot];
      sums_[group_[slot]] += areas_[triangle];
      order_.push_back({group_[slot], mesh_.wedge_triangles()[triangle][corner], slot});
    }
    std::sort(order_.begin(), order_.end());
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const auto& [group, wedge, slot] = order_[i];
      const bool is_new = i == 0 || order_[i - 1].group != group || order_[i - 1].wedge != wedge;
      if (is_new) add_vertex(wedge, sums_[group]);
      const auto [triangle, corner] = stars_.begin(v)[slot];
      result_.triangles[triangle][corner] = static_cast<VertexId>(result_.positions.size() - 1);
    }
  }

  void add_vertex(WedgeId wedge, const glm::dvec3& sum) {
    const double length = glm::length(sum);
    result_.positions.push_back(mesh_.positions[wedge]);
    // Where the sum is zero, clean() computes a normal.
    result_.normals.push_back(length > 0.0 ? glm::vec3(sum / length) : glm::vec3(0.0F));
    if (!mesh_.colors.empty()) result_.colors.push_back(mesh_.colors[wedge]);
    if (!mesh_.texture_coordinates.empty()) result_.texture_coordinates.push_back(mesh_.texture_coordinates[wedge]);
  }

  // Sorted by group, then by wedge.
  struct Ordered {
    std::uint32_t group;
    WedgeId wedge;
    std::uint32_t slot;
    [[nodiscard]] bool operator<(const Ordered& o) const {
      return std::tie(group, wedge, slot) < std::tie(o.group, o.wedge, o.slot);
    }
  };

  const TriangleMesh& mesh_;
  const Stars stars_;
  const bool smooths_all_;
  const double min_cosine_;
  std::vector<glm::dvec3> areas_;  // area vectors of triangles, with twice their area as length
  TriangleMesh result_;
  std::vector<Spoke> spokes_;  // of the current vertex, as are the members below
  std::vector<std::uint32_t> group_;
  std::vector<glm::dvec3> sums_;  // by group
  std::vector<Ordered> order_;
};

}  // namespace

TriangleMesh crease_normals(const TriangleMesh& mesh, double degrees) {
  OptionChecker("crease").in_range("degrees", degrees, 0.0, 180.0);
  TriangleMesh clean_mesh = clean(mesh, {}, "mesh").mesh;
  return clean(Creaser(clean_mesh, degrees).run(), {}, "mesh").mesh;
}

}  // namespace occlod
