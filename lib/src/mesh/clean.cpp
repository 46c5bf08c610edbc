#include "occlod/mesh/clean.h"

#include <fmt/format.h>

#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <utility>

#include "mesh/portable_math.h"
#include "occlod/core/error.h"

namespace occlod {
namespace {

bool is_finite(const glm::vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

bool has_repeated_corner(const Triangle& t) { return t.x == t.y || t.y == t.z || t.z == t.x; }

// Finds the first vertex with the same coordinates: open addressing over vertex ids, at most half full.
class PositionTable {
 public:
  explicit PositionTable(const std::vector<glm::vec3>& positions)
      : positions_(positions), slots_(std::bit_ceil(2 * positions.size() + 1), no_id) {}

  // The vertex inserted earlier at the position of `vertex`, or `vertex` itself.
  VertexId find_or_insert(VertexId vertex) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = hash(positions_[vertex]) & mask;
    while (slots_[slot] != no_id && positions_[slots_[slot]] != positions_[vertex]) slot = (slot + 1) & mask;
    if (slots_[slot] == no_id) slots_[slot] = vertex;
    return slots_[slot];
  }

 private:
  static std::size_t hash(const glm::vec3& p) {
    const glm::vec3 positive_zero = p + 0.0f;
    std::uint32_t bits[3];
    std::memcpy(bits, &positive_zero, sizeof bits);
    return scatter(scatter(bits[0] | std::uint64_t{bits[1]} << 32) + bits[2]);
  }

  const std::vector<glm::vec3>& positions_;
  std::vector<VertexId> slots_;
};

class Cleaner {
 public:
  Cleaner(TriangleMesh mesh, const MeshReport& report, const std::string& subject)
      : mesh_(std::move(mesh)), report_(report), subject_(subject), leader_(mesh_.vertex_count(), no_id) {
    assert(mesh_.normals.empty() || mesh_.normals.size() == mesh_.vertex_count());
    assert(mesh_.colors.empty() || mesh_.colors.size() == mesh_.vertex_count());
    if (report_.vertices_read == 0) {
      report_.vertices_read = mesh_.vertex_count();
      report_.triangles_read = report_.polygons_read = mesh_.triangle_count();
    }
  }

  CleanMesh run() && {
    if (mesh_.triangles.empty()) fail("", "has no triangles", "give a mesh with at least one");
    check_indices();
    find_leaders();
    average_attributes();
    relabel_triangles();
    if (mesh_.triangles.empty()) {
      fail("", "has no triangle with three different corners", "give a mesh with at least one");
    }
    drop_unused_vertices();
    repair_normals();
    count_topology(mesh_, report_);
    return {std::move(mesh_), report_};
  }

 private:
  [[noreturn]] void fail(std::string place, std::string problem, std::string mend) const {
    throw Error({subject_, std::move(place), std::move(problem), std::move(mend)});
  }

  void check_indices() const {
    for (std::size_t t = 0; t < mesh_.triangle_count(); ++t) {
      for (int corner = 0; corner < 3; ++corner) {
        const VertexId v = mesh_.triangles[t][corner];
        if (v < mesh_.vertex_count()) continue;
        fail(fmt::format("triangle {}", t),
             fmt::format("uses vertex {}, but there are {} vertices, numbered from 0", v, mesh_.vertex_count()),
             "export the mesh again");
      }
    }
  }

  // leader_[v]: the first used vertex at the position of v, or no_id where no triangle uses v.
  void find_leaders() {
    for (const Triangle& t : mesh_.triangles) leader_[t.x] = leader_[t.y] = leader_[t.z] = 0;
    PositionTable table(mesh_.positions);
    for (VertexId v = 0; v < mesh_.vertex_count(); ++v) {
      const bool finite = is_finite(mesh_.positions[v]);
      if (leader_[v] == no_id) {
        ++(finite ? report_.unreferenced_vertices : report_.nonfinite_vertices);
        continue;
      }
      if (!finite) {
        fail(fmt::format("vertex {}, numbered from 0", v), "a coordinate is NaN or infinite",
             "remove the vertex and its faces, or export the mesh again");
      }
      leader_[v] = table.find_or_insert(v);
      if (leader_[v] != v) ++report_.vertices_welded;
    }
  }

  void average_attributes() {
    std::vector<bool> conflict(mesh_.vertex_count());
    average_normals(conflict);
    average_colors(conflict);
    for (const bool differs : conflict) report_.attribute_conflicts += differs;
  }

  // Sums now; repair_normals() brings them to unit length.
  void average_normals(std::vector<bool>& conflict) {
    std::vector<glm::vec3>& normals = mesh_.normals;
    if (normals.empty() || report_.vertices_welded == 0) return;
    const std::vector<glm::vec3> original = normals;
    for (VertexId v = 0; v < normals.size(); ++v) {
      const VertexId leader = leader_[v];
      if (leader == no_id || leader == v) continue;
      if (original[v] != original[leader]) conflict[leader] = true;
      normals[leader] += original[v];
    }
  }

  void average_colors(std::vector<bool>& conflict) {
    std::vector<glm::u8vec4>& colors = mesh_.colors;
    if (colors.empty() || report_.vertices_welded == 0) return;
    std::vector<glm::u64vec4> sums(colors.size(), glm::u64vec4(0));
    std::vector<std::uint32_t> counts(colors.size(), 0);
    for (VertexId v = 0; v < colors.size(); ++v) {
      const VertexId leader = leader_[v];
      if (leader == no_id) continue;
      if (colors[v] != colors[leader]) conflict[leader] = true;
      sums[leader] += glm::u64vec4(colors[v]);
      ++counts[leader];
    }
    for (VertexId v = 0; v < colors.size(); ++v) {
      if (counts[v] > 1) colors[v] = glm::u8vec4((sums[v] + std::uint64_t{counts[v] / 2}) / std::uint64_t{counts[v]});
    }
  }

  void relabel_triangles() {
    for (Triangle& t : mesh_.triangles) t = {leader_[t.x], leader_[t.y], leader_[t.z]};
    report_.repeated_index_triangles += std::erase_if(mesh_.triangles, has_repeated_corner);
  }

  // Also drops leaders whose triangles were all dropped.
  void drop_unused_vertices() {
    std::vector<VertexId> new_id(mesh_.vertex_count(), no_id);
    for (const Triangle& t : mesh_.triangles) new_id[t.x] = new_id[t.y] = new_id[t.z] = 0;
    VertexId kept = 0;
    for (VertexId v = 0; v < new_id.size(); ++v) {
      if (new_id[v] == no_id) {
        report_.unreferenced_vertices += leader_[v] == v;
        continue;
      }
      new_id[v] = kept;
      mesh_.positions[kept] = mesh_.positions[v];
      if (!mesh_.normals.empty()) mesh_.normals[kept] = mesh_.normals[v];
      if (!mesh_.colors.empty()) mesh_.colors[kept] = mesh_.colors[v];
      ++kept;
    }
    mesh_.positions.resize(kept);
    if (!mesh_.normals.empty()) mesh_.normals.resize(kept);
    if (!mesh_.colors.empty()) mesh_.colors.resize(kept);
    for (Triangle& t : mesh_.triangles) t = {new_id[t.x], new_id[t.y], new_id[t.z]};
  }

  // Unit length for all; one that is zero or not finite becomes the area-weighted normal of its triangles, or +z where
  // those cancel out.
  void repair_normals() {
    if (mesh_.normals.empty()) return;
    std::vector<bool> unusable(mesh_.vertex_count());
    std::size_t unusable_count = 0;
    for (VertexId v = 0; v < mesh_.vertex_count(); ++v) {
      unusable[v] = !normalize_in_place(mesh_.normals[v]);
      unusable_count += unusable[v];
    }
    if (unusable_count == 0) return;
    std::vector<glm::dvec3> sums(mesh_.vertex_count(), glm::dvec3(0.0));
    for (const Triangle& t : mesh_.triangles) {
      const glm::dvec3 a(mesh_.positions[t.x]);
      const glm::dvec3 area = glm::cross(glm::dvec3(mesh_.positions[t.y]) - a, glm::dvec3(mesh_.positions[t.z]) - a);
      for (int corner = 0; corner < 3; ++corner) sums[t[corner]] += area;
    }
    for (VertexId v = 0; v < mesh_.vertex_count(); ++v) {
      if (!unusable[v]) continue;
      const double length = glm::length(sums[v]);
      mesh_.normals[v] = length > 0.0 && std::isfinite(length) ? glm::vec3(sums[v] / length) : glm::vec3(0, 0, 1);
    }
  }

  static bool normalize_in_place(glm::vec3& normal) {
    const double length = glm::length(glm::dvec3(normal));
    if (!(length > 0.0) || !std::isfinite(length)) return false;
    normal = glm::vec3(glm::dvec3(normal) / length);
    return true;
  }

  TriangleMesh mesh_;
  MeshReport report_;
  const std::string& subject_;
  std::vector<VertexId> leader_;
};

}  // namespace

CleanMesh clean(TriangleMesh mesh, const MeshReport& report, const std::string& subject) {
  return Cleaner(std::move(mesh), report, subject).run();
}

}  // namespace occlod
