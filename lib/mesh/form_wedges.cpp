#include "mesh/form_wedges.h"

#include <bit>
#include <cstdint>
#include <utility>

#include "base/portable_math.h"

namespace occlod {
namespace {

// The attributes that a corner may have: those of a vertex as read, and a material.
struct Attributes {
  VertexId vertex;  // of the corner, welded
  VertexId source;  // as read
  MaterialId material;
};

// Finds wedges beyond the first of their vertices by vertex and attributes: open addressing, at most half full.
class ExtraWedges {
 public:
  explicit ExtraWedges(const TriangleMesh& mesh) : mesh_(mesh), slots_(64, no_id) {}

  // The number of the wedge with these attributes, in the order in which they were first asked for.
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
    return a.vertex == b.vertex && a.material == b.material && have_equal_attributes(a.source, b.source);
  }

  // Of +0 also for -0.
  static std::uint64_t bits(float a, float b) {
    return std::bit_cast<std::uint32_t>(a + 0.0F) | std::uint64_t{std::bit_cast<std::uint32_t>(b + 0.0F)} << 32;
  }

  [[nodiscard]] std::size_t hash_of(const Attributes& of) const {
    std::uint64_t hash = scatter(of.vertex | std::uint64_t{of.material} << 32);
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
  std::vector<std::uint32_t> slots_;  // into wedges_
};

class WedgeFormer {
 public:
  WedgeFormer(TriangleMesh& mesh, std::vector<Triangle> corners)
      : mesh_(mesh), corners_(std::move(corners)), first_(mesh.positions.size(), no_id), extra_(mesh) {}

  bool run() && {
    if (!mesh_.triangle_materials.empty()) first_material_.resize(first_.size());
    const auto vertices_read = static_cast<std::uint64_t>(first_.size());
    for (std::size_t t = 0; t < corners_.size(); ++t) {
      for (int k = 0; k < 3; ++k) find_wedge(mesh_.triangles[t][k], corners_[t][k], mesh_.material_of(t));
      if (vertices_read + extra_.wedges().size() >= no_id) return false;
    }
    number_vertices();
    number_extra_wedges();
    move_arrays();
    return true;
  }

 private:
  // Replaces the vertex as read at a corner by its wedge: the vertex itself for its first, then those of extra_.
  void find_wedge(VertexId vertex, VertexId& corner, MaterialId material) {
    VertexId& first = first_[vertex];
    if (first == no_id) {
      first = corner;
      if (!first_material_.empty()) first_material_[vertex] = material;
    }
    const bool same_material = first_material_.empty() || first_material_[vertex] == material;
    if (same_material && extra_.have_equal_attributes(first, corner))
      corner = vertex;
    else
      corner = static_cast<VertexId>(first_.size()) + extra_.find_or_add({vertex, corner, material});
  }

  void number_vertices() {
    new_id_.resize(first_.size());
    for (std::size_t v = 0; v < first_.size(); ++v) {
      if (first_[v] != no_id) new_id_[v] = vertex_count_++;
    }
  }

  // Sorts the extra wedges by vertex, those of one vertex in their order: counted, then placed.
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
    // All wedges of a vertex have its place to the bit, also where -0 was welded to +0.
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
  std::vector<VertexId> first_;  // by vertex: whose attributes its first wedge has; no_id where it is not used
  std::vector<MaterialId> first_material_;  // by vertex; empty where all triangles have one
  ExtraWedges extra_;
  std::vector<VertexId> new_id_;       // by vertex
  std::vector<WedgeId> new_extra_id_;  // by number in extra_
  VertexId vertex_count_ = 0;
};

}  // namespace

bool form_wedges(TriangleMesh& mesh, std::vector<Triangle> read_corners) {
  return WedgeFormer(mesh, std::move(read_corners)).run();
}

}  // namespace occlod
