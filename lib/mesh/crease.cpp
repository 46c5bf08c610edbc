#include "occlod/mesh/crease.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "base/option_checker.h"
#include "occlod/mesh/clean.h"

namespace occlod {
namespace {

// One corner of the star of a vertex.
struct StarCorner {
  std::uint32_t triangle;
  int corner;  // 0, 1 or 2
};

// The corners at each vertex, by ascending triangles.
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
      : mesh_(mesh), stars_(mesh), smooths_all_(degrees >= 180.0), least_cosine_(std::cos(degrees * radians) - slack) {
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
    result_.materials = mesh_.materials;
    result_.textures = mesh_.textures;
    result_.texture_origin = mesh_.texture_origin;
    return std::move(result_);
  }

 private:
  static constexpr double radians = 0.017453292519943295;
  static constexpr double slack = 1e-12;  // of cosines, for rounding: triangles in one plane are smooth at 0 degrees

  // A triangle's use of an edge at the vertex.
  struct Spoke {
    VertexId rim;
    std::uint32_t slot;  // of the triangle in the star
  };

  // Sets group_ of each slot of the star: the smallest slot that it is joined with.
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

  // A triangle without area has no angle and is smooth with any.
  [[nodiscard]] bool are_smooth(std::uint32_t a, std::uint32_t b) const {
    const double lengths = glm::length(areas_[a]) * glm::length(areas_[b]);
    return smooths_all_ || !(lengths > 0.0) || glm::dot(areas_[a], areas_[b]) >= least_cosine_ * lengths;
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

  // A vertex of the result for each pair of a group and a wedge that are met at the same corner; clean() makes wedges
  // of them.
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
    // Without an area clean() finds one.
    result_.normals.push_back(length > 0.0 ? glm::vec3(sum / length) : glm::vec3(0.0F));
    if (!mesh_.colors.empty()) result_.colors.push_back(mesh_.colors[wedge]);
    if (!mesh_.texture_coordinates.empty()) result_.texture_coordinates.push_back(mesh_.texture_coordinates[wedge]);
  }

  // By group, then by wedge.
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
  const double least_cosine_;
  std::vector<glm::dvec3> areas_;  // of triangles, twice
  TriangleMesh result_;
  std::vector<Spoke> spokes_;  // of the current vertex, as are those below
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
