#include <algorithm>
#include <numeric>

#include "occlod/mesh/clean.h"

namespace occlod {
namespace {

// Sets of vertices or triangles that are joined step by step.
class DisjointSets {
 public:
  void reset(std::size_t count) {
    parent_.resize(count);
    std::iota(parent_.begin(), parent_.end(), 0u);
  }

  // False when the two were in one set already.
  bool join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return false;
    parent_[std::max(a, b)] = std::min(a, b);
    return true;
  }

 private:
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  std::vector<std::uint32_t> parent_;
};

bool has_repeated_corner(const Triangle& t) { return t.x == t.y || t.y == t.z || t.z == t.x; }

// Exact while the coordinates of a triangle are less than 2^26 units in the last place apart, as they nearly always
// are: the products of such differences fit in a double.
bool has_zero_area(const TriangleMesh& mesh, const Triangle& t) {
  const glm::dvec3 a(mesh.positions[t.x]);
  const glm::dvec3 u = glm::dvec3(mesh.positions[t.y]) - a;
  const glm::dvec3 v = glm::dvec3(mesh.positions[t.z]) - a;
  return u.y * v.z == u.z * v.y && u.z * v.x == u.x * v.z && u.x * v.y == u.y * v.x;
}

// The triangles round each vertex, as one array with offsets.
class Stars {
 public:
  explicit Stars(const TriangleMesh& mesh) : offsets_(mesh.vertex_count() + 1, 0) {
    for_each_corner(mesh, [&](VertexId v, std::uint32_t) { ++offsets_[v]; });
    std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
    triangles_.resize(offsets_.back());
    for_each_corner(mesh, [&](VertexId v, std::uint32_t t) { triangles_[--offsets_[v]] = t; });
  }

  [[nodiscard]] std::size_t begin(VertexId v) const { return offsets_[v]; }
  [[nodiscard]] std::size_t size(VertexId v) const { return offsets_[v + 1] - offsets_[v]; }
  [[nodiscard]] std::uint32_t triangle(std::size_t i) const { return triangles_[i]; }

 private:
  template <class Visit>
  static void for_each_corner(const TriangleMesh& mesh, Visit visit) {
    for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
      if (has_repeated_corner(mesh.triangles[t])) continue;
      for (int corner = 0; corner < 3; ++corner) visit(mesh.triangles[t][corner], t);
    }
  }

  std::vector<std::size_t> offsets_;
  std::vector<std::uint32_t> triangles_;
};

// Counts what can be seen in the star of one vertex at a time; an edge counts at its smaller vertex, a triangle at its
// smallest.
class StarCounter {
 public:
  StarCounter(const TriangleMesh& mesh, MeshReport& report) : mesh_(mesh), stars_(mesh), report_(report) {}

  void count(VertexId center) {
    spokes_.clear();
    opposite_.clear();
    for (std::uint32_t slot = 0; slot < stars_.size(center); ++slot) add_triangle(center, slot);
    std::sort(spokes_.begin(), spokes_.end(), [](const Spoke& a, const Spoke& b) { return a.rim < b.rim; });
    count_spokes(center);
    count_repeated();
  }

 private:
  // One triangle's use of the edge between the centre and `rim`.
  struct Spoke {
    VertexId rim;
    std::uint32_t slot;  // the triangle's place in the star
    bool outward;        // the triangle runs from the centre to the rim
  };

  void add_triangle(VertexId center, std::uint32_t slot) {
    const Triangle& t = mesh_.triangles[stars_.triangle(stars_.begin(center) + slot)];
    const int corner = t.x == center ? 0 : t.y == center ? 1 : 2;
    const VertexId next = t[(corner + 1) % 3];
    const VertexId previous = t[(corner + 2) % 3];
    spokes_.push_back({next, slot, true});
    spokes_.push_back({previous, slot, false});
    if (center < next && center < previous) opposite_.emplace_back(std::min(next, previous), std::max(next, previous));
  }

  void count_spokes(VertexId center) {
    const std::size_t star_size = stars_.size(center);
    std::size_t fans = star_size;
    fans_.reset(star_size);
    for (std::size_t first = 0, last = 0; first < spokes_.size(); first = last) {
      for (last = first; last < spokes_.size() && spokes_[last].rim == spokes_[first].rim; ++last) {
        fans -= fans_.join(spokes_[first].slot, spokes_[last].slot);
      }
      if (center < spokes_[first].rim) count_edge(&spokes_[first], last - first);
    }
    report_.nonmanifold_vertices += fans > 1;
  }

  void count_edge(const Spoke* uses, std::size_t count) {
    report_.boundary_edges += count == 1;
    report_.nonmanifold_edges += count > 2;
    report_.inconsistent_edges += count == 2 && uses[0].outward == uses[1].outward;
  }

  void count_repeated() {
    std::sort(opposite_.begin(), opposite_.end());
    for (std::size_t i = 1; i < opposite_.size(); ++i) report_.repeated_triangles += opposite_[i] == opposite_[i - 1];
  }

  const TriangleMesh& mesh_;
  Stars stars_;
  MeshReport& report_;
  std::vector<Spoke> spokes_;
  std::vector<std::pair<VertexId, VertexId>> opposite_;  // the other two corners of each triangle counted here
  DisjointSets fans_;
};

std::uint64_t count_components(const TriangleMesh& mesh) {
  DisjointSets sets;
  sets.reset(mesh.vertex_count());
  std::vector<bool> used(mesh.vertex_count());
  std::uint64_t joins = 0;
  for (const Triangle& t : mesh.triangles) {
    used[t.x] = used[t.y] = used[t.z] = true;
    joins += sets.join(t.x, t.y);
    joins += sets.join(t.x, t.z);
  }
  return static_cast<std::uint64_t>(std::count(used.begin(), used.end(), true)) - joins;
}

}  // namespace

void count_topology(const TriangleMesh& mesh, MeshReport& report) {
  report.zero_area_triangles = 0;
  for (const Triangle& t : mesh.triangles) {
    report.zero_area_triangles += !has_repeated_corner(t) && has_zero_area(mesh, t);
  }
  report.repeated_triangles = 0;
  report.boundary_edges = report.nonmanifold_edges = report.inconsistent_edges = report.nonmanifold_vertices = 0;
  StarCounter counter(mesh, report);
  for (VertexId v = 0; v < mesh.vertex_count(); ++v) counter.count(v);
  report.components = count_components(mesh);
}

}  // namespace occlod
