#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/arithmetic.h"
#include "mesh/wedges.h"
#include "occlod/base.h"
#include "occlod/mesh.h"

namespace occlod {
namespace {

bool is_finite(const glm::vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

bool has_repeated_corner(const Triangle& t) { return t.x == t.y || t.y == t.z || t.z == t.x; }

// Equal positions have equal hashes, and +0 equals -0.
std::size_t hash_of(const glm::vec3& p) {
  const glm::vec3 positive_zero = p + 0.0f;
  std::uint32_t bits[3];
  std::memcpy(bits, &positive_zero, sizeof bits);
  return scatter(scatter(bits[0] | std::uint64_t{bits[1]} << 32) + bits[2]);
}

// A filter that separates most vertices with a unique position from those that may share theirs, in a byte or two per
// vertex: one bit for each of many more slots than vertices, which fit in cache for all but the largest meshes.
class SharedSlots {
 public:
  explicit SharedSlots(std::size_t vertices)
      : mask_(std::bit_ceil(slots_per_vertex * vertices + 64) - 1),
        taken_((mask_ + 1) / 64),
        shared_((mask_ + 1) / 64) {}

  void add(const glm::vec3& p) {
    const auto [word, bit] = slot_of(p);
    if ((taken_[word] & bit) != 0)
      shared_[word] |= bit;
    else
      taken_[word] |= bit;
  }
  // True when another added position equals `p` or happens to have its slot.
  [[nodiscard]] bool is_shared(const glm::vec3& p) const {
    const auto [word, bit] = slot_of(p);
    return (shared_[word] & bit) != 0;
  }

 private:
  static constexpr std::size_t slots_per_vertex = 8;  // about one vertex in ten shares a slot by chance

  struct Slot {
    std::size_t word;
    std::uint64_t bit;
  };

  [[nodiscard]] Slot slot_of(const glm::vec3& p) const {
    const std::size_t slot = hash_of(p) & mask_;
    return {slot / 64, std::uint64_t{1} << (slot % 64)};
  }

  std::size_t mask_;
  std::vector<std::uint64_t> taken_;
  std::vector<std::uint64_t> shared_;  // slots that were taken at least twice
};

// Finds the first vertex with the same coordinates: open addressing over vertex ids, at most half full.
class PositionTable {
 public:
  PositionTable(const std::vector<glm::vec3>& positions, std::size_t max_vertices)
      : positions_(positions), slots_(std::bit_ceil(2 * max_vertices + 1), no_id) {}

  // Returns the vertex inserted earlier at the position of `vertex`, or `vertex` itself.
  VertexId find_or_insert(VertexId vertex) {
    const std::size_t mask = slots_.size() - 1;
    std::size_t slot = hash_of(positions_[vertex]) & mask;
    while (slots_[slot] != no_id && positions_[slots_[slot]] != positions_[vertex]) slot = (slot + 1) & mask;
    if (slots_[slot] == no_id) slots_[slot] = vertex;
    return slots_[slot];
  }

 private:
  const std::vector<glm::vec3>& positions_;
  std::vector<VertexId> slots_;
};

class Cleaner {
 public:
  Cleaner(TriangleMesh mesh, const MeshReport& report, const std::string& subject, int threads)
      : mesh_(std::move(mesh)), report_(report), subject_(subject), threads_(threads) {
    assert(mesh_.normals.empty() || mesh_.normals.size() == mesh_.wedge_count());
    assert(mesh_.colors.empty() || mesh_.colors.size() == mesh_.wedge_count());
    assert(mesh_.texture_coordinates.empty() || mesh_.texture_coordinates.size() == mesh_.wedge_count());
    assert(mesh_.triangle_materials.empty() || mesh_.triangle_materials.size() == mesh_.triangle_count());
    assert(mesh_.triangle_features.empty() || mesh_.triangle_features.size() == mesh_.triangle_count());
    assert(mesh_.corners.empty() || mesh_.corners.size() == mesh_.triangle_count());
    if (report_.vertices_read == 0) {
      report_.vertices_read = mesh_.vertex_count();
      report_.triangles_read = report_.polygons_read = mesh_.triangle_count();
    }
    // Existing wedges are formed anew.
    if (!mesh_.corners.empty()) mesh_.triangles = std::move(mesh_.corners);
    mesh_.corners.clear();
    mesh_.extra_wedges.clear();
  }

  CleanMesh run() && {
    if (mesh_.triangles.empty()) fail("", "has no triangles", "give a mesh with at least one");
    check_indices();
    check_materials();
    check_features();
    used_ = used_vertices();
    check_positions();
    repair_texture_coordinates();
    find_leaders();
    std::vector<Triangle> read_corners;
    if (may_have_extra_wedges()) read_corners = mesh_.triangles;
    relabel_triangles(read_corners);
    if (mesh_.triangles.empty()) {
      fail("", "has no triangle with three different corners", "give a mesh with at least one");
    }
    repair_normals();
    drop_unused_vertices(std::move(read_corners));
    count_topology(mesh_, report_, threads_);
    return {std::move(mesh_), report_};
  }

 private:
  [[noreturn]] void fail(std::string place, std::string problem, std::string remedy) const {
    throw Error({subject_, std::move(place), std::move(problem), std::move(remedy)});
  }

  void check_indices() const {
    VertexId largest = 0;
    for (const Triangle& t : mesh_.triangles) largest = std::max({largest, t.x, t.y, t.z});
    if (largest < mesh_.vertex_count()) return;
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

  // Checks materials and drops triangle_materials when all triangles have the first material.
  void check_materials() {
    for (std::size_t m = 0; m < mesh_.materials.size(); ++m) {
      const TextureId texture = mesh_.materials[m].texture_beyond(mesh_.textures.size());
      if (texture == no_texture) continue;
      fail(fmt::format("material {}", m),
           fmt::format("has texture {}, but there are {}, numbered from 0", texture, mesh_.textures.size()),
           "export the mesh again");
    }
    const std::size_t materials = std::max<std::size_t>(mesh_.materials.size(), 1);
    bool has_others = false;  // than the first material
    for (std::size_t t = 0; t < mesh_.triangle_materials.size(); ++t) {
      const MaterialId material = mesh_.triangle_materials[t];
      has_others |= material != 0;
      if (material < materials) continue;
      fail(fmt::format("triangle {}", t),
           fmt::format("has material {}, but there are {}, numbered from 0", material, mesh_.materials.size()),
           "export the mesh again");
    }
    if (!has_others) mesh_.triangle_materials.clear();
  }

  void check_features() const {
    for (std::size_t t = 0; t < mesh_.triangle_features.size(); ++t)
      if (mesh_.triangle_features[t] >= mesh_.feature_names.size())
        fail(fmt::format("triangle {}", t),
             fmt::format("has feature {}, but there are {}, numbered from 0", mesh_.triangle_features[t],
                         mesh_.feature_names.size()),
             "export the mesh again");
  }

  // Returns 1 for each vertex that a triangle uses. Bytes are used instead of bits so that a store needs no load.
  [[nodiscard]] std::vector<std::uint8_t> used_vertices() const {
    std::vector<std::uint8_t> used(mesh_.vertex_count(), 0);
    for (const Triangle& t : mesh_.triangles) used[t.x] = used[t.y] = used[t.z] = 1;
    return used;
  }

  void check_positions() {
    for (VertexId v = 0; v < mesh_.vertex_count(); ++v) {
      const bool finite = is_finite(mesh_.positions[v]);
      if (used_[v] == 0) {
        if (is_of_file(v)) ++(finite ? report_.unreferenced_vertices : report_.nonfinite_vertices);
      } else if (!finite) {
        fail(fmt::format("vertex {}, numbered from 0", v), "a coordinate is NaN or infinite",
             "remove the vertex and its faces, or export the mesh again");
      } else if (largest_coordinate(mesh_.positions[v]) > farthest_coordinate) {
        fail(fmt::format("vertex {}, numbered from 0", v), "is farther than 1.5e37 from the origin",
             "scale the mesh down");
      }
    }
  }

  // True unless the vertex is a further wedge of an earlier one; those come last.
  [[nodiscard]] bool is_of_file(VertexId v) const { return v < report_.vertices_read; }

  void repair_texture_coordinates() {
    for (std::size_t v = 0; v < mesh_.texture_coordinates.size(); ++v) {
      glm::vec2& at = mesh_.texture_coordinates[v];
      if (std::isfinite(at.x) && std::isfinite(at.y)) continue;
      at = glm::vec2(0.0F);
      report_.left_out.add(not_finite_coordinates, used_[v]);
    }
  }

  // Returns the used vertices that may have the position of another one, ascending.
  [[nodiscard]] std::vector<VertexId> maybe_shared() const {
    SharedSlots slots(mesh_.vertex_count());
    for (VertexId v = 0; v < mesh_.vertex_count(); ++v) {
      if (used_[v] != 0) slots.add(mesh_.positions[v]);
    }
    std::vector<VertexId> vertices;
    for (VertexId v = 0; v < mesh_.vertex_count(); ++v) {
      if (used_[v] != 0 && slots.is_shared(mesh_.positions[v])) vertices.push_back(v);
    }
    return vertices;
  }

  void find_leaders() {
    const std::vector<VertexId> vertices = maybe_shared();
    PositionTable table(mesh_.positions, vertices.size());
    for (const VertexId v : vertices) {
      const VertexId first = table.find_or_insert(v);
      if (first == v) continue;
      if (leader_.empty()) {
        leader_.resize(mesh_.vertex_count());
        std::iota(leader_.begin(), leader_.end(), VertexId{0});
      }
      leader_[v] = first;
      report_.vertices_welded += is_of_file(v);
    }
  }

  // True when two corners of a vertex may differ in attributes or material.
  [[nodiscard]] bool may_have_extra_wedges() const {
    const bool has_attributes = !mesh_.normals.empty() || !mesh_.colors.empty() || !mesh_.texture_coordinates.empty();
    return (!leader_.empty() && has_attributes) || !mesh_.triangle_materials.empty();
  }

  // Replaces vertices by the ones into which they were welded, and drops triangles that then repeat a corner, with
  // their entries in `read_corners`, if given.
  void relabel_triangles(std::vector<Triangle>& read_corners) {
    if (!leader_.empty()) {
      for (Triangle& t : mesh_.triangles) t = {leader_[t.x], leader_[t.y], leader_[t.z]};
    }
    std::vector<MaterialId>& materials = mesh_.triangle_materials;
    std::vector<FeatureId>& features = mesh_.triangle_features;
    if (read_corners.empty() && materials.empty() && features.empty()) {
      report_.repeated_index_triangles += std::erase_if(mesh_.triangles, has_repeated_corner);
      return;
    }
    std::size_t kept = 0;
    for (std::size_t t = 0; t < mesh_.triangle_count(); ++t) {
      if (has_repeated_corner(mesh_.triangles[t])) continue;
      mesh_.triangles[kept] = mesh_.triangles[t];
      if (!read_corners.empty()) read_corners[kept] = read_corners[t];
      if (!materials.empty()) materials[kept] = materials[t];
      if (!features.empty()) features[kept] = features[t];
      ++kept;
    }
    report_.repeated_index_triangles += mesh_.triangle_count() - kept;
    mesh_.triangles.resize(kept);
    if (!read_corners.empty()) read_corners.resize(kept);
    if (!materials.empty()) materials.resize(kept);
    if (!features.empty()) features.resize(kept);
  }

  // Drops unused vertices, including those whose triangles were all dropped after welding.
  void drop_unused_vertices(std::vector<Triangle> read_corners) {
    const bool triangles_changed = !leader_.empty() || report_.repeated_index_triangles > 0;
    const std::vector<std::uint8_t> still_used = triangles_changed ? used_vertices() : used_;
    for (VertexId v = 0; triangles_changed && v < still_used.size(); ++v) {
      const bool was_leader = used_[v] != 0 && (leader_.empty() || leader_[v] == v);
      report_.unreferenced_vertices += still_used[v] == 0 && was_leader && is_of_file(v);
    }
    if (read_corners.empty()) return move_vertices(still_used);
    if (!form_wedges(mesh_, std::move(read_corners))) fail("", "has too many vertices", "split the mesh into parts");
    const std::vector<VertexId>& extra = mesh_.extra_wedges;
    for (std::size_t i = 0; i < extra.size(); ++i) report_.seam_vertices += i == 0 || extra[i] != extra[i - 1];
  }

  void move_vertices(const std::vector<std::uint8_t>& still_used) {
    if (std::ranges::find(still_used, 0) == still_used.end()) return;
    std::vector<VertexId> new_id(mesh_.vertex_count());
    VertexId kept = 0;
    for (VertexId v = 0; v < new_id.size(); ++v) {
      if (still_used[v] == 0) continue;
      new_id[v] = kept;
      mesh_.positions[kept] = mesh_.positions[v];
      if (!mesh_.normals.empty()) mesh_.normals[kept] = mesh_.normals[v];
      if (!mesh_.colors.empty()) mesh_.colors[kept] = mesh_.colors[v];
      if (!mesh_.texture_coordinates.empty()) mesh_.texture_coordinates[kept] = mesh_.texture_coordinates[v];
      ++kept;
    }
    mesh_.positions.resize(kept);
    if (!mesh_.normals.empty()) mesh_.normals.resize(kept);
    if (!mesh_.colors.empty()) mesh_.colors.resize(kept);
    if (!mesh_.texture_coordinates.empty()) mesh_.texture_coordinates.resize(kept);
    for (Triangle& t : mesh_.triangles) t = {new_id[t.x], new_id[t.y], new_id[t.z]};
  }

  // Gives all normals unit length; one that is zero or not finite becomes the area-weighted normal of the triangles at
  // its position, or +z where those cancel out.
  void repair_normals() {
    if (mesh_.normals.empty()) return;
    std::vector<bool> unusable(mesh_.vertex_count());
    std::size_t unusable_count = 0;
    for (VertexId v = 0; v < mesh_.vertex_count(); ++v) {
      unusable[v] = used_[v] != 0 && !normalize_in_place(mesh_.normals[v]);
      unusable_count += unusable[v];
    }
    if (unusable_count == 0) return;
    std::vector<glm::dvec3> sums(mesh_.vertex_count(), glm::dvec3(0.0));
    for (const Triangle& t : mesh_.triangles) {
      const glm::dvec3 area = area_vector(mesh_.positions[t.x], mesh_.positions[t.y], mesh_.positions[t.z]);
      for (int corner = 0; corner < 3; ++corner) sums[t[corner]] += area;
    }
    for (VertexId v = 0; v < mesh_.vertex_count(); ++v) {
      if (!unusable[v]) continue;
      mesh_.normals[v] = normal_along(sums[leader_.empty() ? v : leader_[v]]);
    }
  }

  TriangleMesh mesh_;
  MeshReport report_;
  const std::string& subject_;
  int threads_;
  std::vector<std::uint8_t> used_;  // before welding
  std::vector<VertexId> leader_;    // by vertex: first used vertex at its position; empty when no vertices are welded
};

}  // namespace

CleanMesh clean(TriangleMesh mesh, const MeshReport& report, const std::string& subject, int threads) {
  return Cleaner(std::move(mesh), report, subject, threads).run();
}

float lattice_step(const Box& box, int bits) {
  double extent = 0.0, farthest = 0.0;
  for (int k = 0; k < 3; ++k) {
    extent = std::max(extent, double{box.max[k]} - double{box.min[k]});
    farthest = std::max({farthest, std::abs(double{box.min[k]}), std::abs(double{box.max[k]})});
  }
  if (!(extent > 0.0)) return 0.0F;
  int exponent = 0;
  const double mantissa = std::frexp(std::ldexp(extent, -bits), &exponent);  // in [0.5, 1)
  if (mantissa == 0.5) --exponent;
  const int of_floats = std::ilogb(farthest) - (std::numeric_limits<float>::digits - 1);
  return static_cast<float>(
      std::ldexp(1.0, std::max({exponent, of_floats, std::numeric_limits<float>::min_exponent - 1})));
}

glm::vec3 round_to_lattice(const glm::vec3& p, float step) {
  if (!(step > 0.0F)) return p;
  glm::vec3 rounded;
  for (int k = 0; k < 3; ++k) rounded[k] = std::nearbyint(p[k] / step) * step + 0.0F;  // + 0.0F avoids -0
  return rounded;
}

void round_to_lattice(TriangleMesh& mesh, float step) {
  for (glm::vec3& p : mesh.positions) p = round_to_lattice(p, step);
}

}  // namespace occlod
