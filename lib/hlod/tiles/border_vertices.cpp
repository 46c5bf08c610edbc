#include "hlod/tiles/border_vertices.h"

#include <algorithm>
#include <cstddef>
#include <glm/geometric.hpp>
#include <tuple>
#include <utility>

#include "hlod/tiles/border_edges.h"
#include "hlod/tiles/tile_mesh.h"

namespace occlod::tiles {
namespace {

bool is_before(const glm::vec3& a, const glm::vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

// What one node adds to a vertex.
struct Part {
  glm::vec3 position;
  glm::dvec3 area;
};

struct Edge {
  glm::vec3 a, b;  // a is before b
};

bool is_before(const Edge& x, const Edge& y) { return is_before(x.a, y.a) || (x.a == y.a && is_before(x.b, y.b)); }

// In the order of the nodes, so that sums are the same on every run.
void take_node(const hlod::NodeMesh& mesh, std::vector<Part>& parts, std::vector<Edge>& edges) {
  const std::vector<Triangle> triangles = triangles_of(mesh);
  const std::vector<std::uint32_t> first = first_at_position(mesh.positions);
  const std::vector<glm::dvec3> areas = area_sums(mesh.positions, triangles, first);
  std::vector<bool> is_taken(mesh.positions.size());
  for (const BorderEdge& edge : border_edges(triangles, first)) {
    glm::vec3 a = mesh.positions[edge.from], b = mesh.positions[edge.to];
    if (is_before(b, a)) std::swap(a, b);
    edges.push_back({a, b});
    for (const std::uint32_t v : {first[edge.from], first[edge.to]}) {
      if (is_taken[v]) continue;
      is_taken[v] = true;
      parts.push_back({mesh.positions[v], areas[v]});
    }
  }
}

std::vector<BorderVertex> join(std::vector<Part> parts) {
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Part& x, const Part& y) { return is_before(x.position, y.position); });
  std::vector<BorderVertex> vertices;
  for (std::size_t i = 0, end = 0; i < parts.size(); i = end) {
    glm::dvec3 sum(0.0);
    for (; end < parts.size() && parts[end].position == parts[i].position; ++end) sum += parts[end].area;
    const double length = glm::length(sum);
    vertices.push_back({parts[i].position, length > 0.0 ? glm::vec3(sum / length) : glm::vec3(0.0F), false});
  }
  return vertices;
}

// Of the first that is not before the position.
std::size_t place_of(const std::vector<BorderVertex>& vertices, const glm::vec3& position) {
  const auto found =
      std::lower_bound(vertices.begin(), vertices.end(), position,
                       [](const BorderVertex& vertex, const glm::vec3& p) { return is_before(vertex.position, p); });
  return static_cast<std::size_t>(found - vertices.begin());
}

}  // namespace

BorderVertices::BorderVertices(const hlod::Hlod& hlod, const std::function<void()>& next) {
  std::vector<Part> parts;
  std::vector<Edge> edges;
  const hlod::Level& finest = hlod.data().levels[0];
  for (hlod::NodeId n = finest.first_node; n < finest.first_node + finest.node_count; ++n) {
    next();
    hlod.require(n);
    take_node(hlod.mesh(n), parts, edges);
  }
  vertices_ = join(std::move(parts));
  std::sort(edges.begin(), edges.end(), [](const Edge& x, const Edge& y) { return is_before(x, y); });
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    while (end < edges.size() && edges[end].a == edges[i].a && edges[end].b == edges[i].b) ++end;
    if (end - i > 1) continue;
    for (const glm::vec3& position : {edges[i].a, edges[i].b})
      vertices_[place_of(vertices_, position)].is_at_input_border = true;
  }
}

const BorderVertex* BorderVertices::at(const glm::vec3& position) const {
  const std::size_t place = place_of(vertices_, position);
  return place < vertices_.size() && vertices_[place].position == position ? &vertices_[place] : nullptr;
}

}  // namespace occlod::tiles
