#include "hlod/tiles/tile_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "base/disjoint_sets.h"
#include "hlod/texture/image_place.h"
#include "mesh/wedges.h"
#include "occlod/base.h"
#include "occlod/mesh.h"

namespace occlod::tiles {

std::vector<std::uint32_t> first_at_position(std::span<const glm::vec3> positions) {
  std::vector<std::uint32_t> order(positions.size()), first(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t v) {
    const glm::vec3& p = positions[v];
    return std::tuple(p.x, p.y, p.z);
  };
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
  });
  for (std::size_t i = 0; i < order.size(); ++i)
    first[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? first[order[i - 1]] : order[i];
  return first;
}

std::vector<BorderEdge> border_edges(std::span<const Triangle> triangles, std::span<const std::uint32_t> first) {
  struct Use {
    std::pair<std::uint32_t, std::uint32_t> edge;  // between first vertices, the lesser first
    std::size_t corner;                            // its first corner, of 3 per triangle
  };
  std::vector<Use> uses;
  uses.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = first[triangles[t][k]], b = first[triangles[t][(k + 1) % 3]];
      uses.push_back({std::minmax(a, b), 3 * t + static_cast<std::size_t>(k)});
    }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) { return a.edge < b.edge; });
  std::vector<std::size_t> corners;
  for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
    while (end < uses.size() && uses[end].edge == uses[i].edge) ++end;
    if (end - i == 1) corners.push_back(uses[i].corner);
  }
  std::sort(corners.begin(), corners.end());
  std::vector<BorderEdge> edges;
  edges.reserve(corners.size());
  for (const std::size_t corner : corners) {
    const Triangle& t = triangles[corner / 3];
    const int k = static_cast<int>(corner % 3);
    edges.push_back({t[k], t[(k + 1) % 3], static_cast<std::uint32_t>(corner / 3)});
  }
  return edges;
}

std::vector<glm::dvec3> area_sums(std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                                  std::span<const std::uint32_t> first) {
  std::vector<glm::dvec3> sums(positions.size(), glm::dvec3(0.0));
  for (const Triangle& t : triangles) {
    const glm::dvec3 a(positions[t.x]);
    const glm::dvec3 area = glm::cross(glm::dvec3(positions[t.y]) - a, glm::dvec3(positions[t.z]) - a);
    for (int k = 0; k < 3; ++k) sums[first[t[k]]] += area;
  }
  return sums;
}

namespace {

bool is_before(const glm::vec3& a, const glm::vec3& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

// Adds area vectors up that face within crease_deg of each other, directly or through others; those of each sum keep
// their order. Sums are in the order of their first members, and zero ones are left out. O(n^2) for the vectors at one
// vertex.
void add_up_smooth(std::vector<glm::dvec3>& areas, DisjointSets& groups) {
  static const double min_cosine = std::cos(crease_deg * 0.017453292519943295);
  std::erase_if(areas, [](const glm::dvec3& area) { return !(glm::length(area) > 0.0); });
  groups.reset(areas.size());
  for (std::uint32_t a = 1; a < areas.size(); ++a)
    for (std::uint32_t b = 0; b < a; ++b)
      if (glm::dot(areas[a], areas[b]) >= min_cosine * glm::length(areas[a]) * glm::length(areas[b])) groups.join(a, b);
  std::vector<glm::dvec3> sums;
  std::vector<std::size_t> place(areas.size(), areas.size());  // in sums, by representative
  for (std::uint32_t a = 0; a < areas.size(); ++a) {
    std::size_t& at = place[groups.root(a)];
    if (at == areas.size()) {
      at = sums.size();
      sums.emplace_back(0.0);
    }
    sums[at] += areas[a];
  }
  areas = std::move(sums);
}

// Holds what one node adds to a vertex: the sum of the area vectors of triangles that are smooth there.
struct Part {
  glm::vec3 position;
  glm::dvec3 area;
};

struct Edge {
  glm::vec3 a, b;  // a is less than b
};

bool is_before(const Edge& x, const Edge& y) { return is_before(x.a, y.a) || (x.a == y.a && is_before(x.b, y.b)); }

// Must be called in the order of the nodes, so that sums are the same in every run.
void take_node(const hlod::NodeMesh& mesh, std::vector<Part>& parts, std::vector<Edge>& edges) {
  const std::vector<Triangle> triangles = triangles_of(mesh);
  const std::vector<std::uint32_t> first = first_at_position(mesh.positions);
  std::vector<bool> is_border(mesh.positions.size());
  for (const BorderEdge& edge : border_edges(triangles, first)) {
    glm::vec3 a = mesh.positions[edge.from], b = mesh.positions[edge.to];
    if (is_before(b, a)) std::swap(a, b);
    edges.push_back({a, b});
    is_border[first[edge.from]] = is_border[first[edge.to]] = true;
  }
  std::vector<std::pair<std::uint32_t, std::uint32_t>> stars;  // vertices of the border, and their triangles
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (const std::uint32_t v = first[triangles[t][k]]; is_border[v]) stars.emplace_back(v, t);
  std::sort(stars.begin(), stars.end());
  std::vector<glm::dvec3> areas;
  DisjointSets groups;
  for (std::size_t i = 0, end = 0; i < stars.size(); i = end) {
    areas.clear();
    for (; end < stars.size() && stars[end].first == stars[i].first; ++end) {
      const Triangle& t = triangles[stars[end].second];
      areas.push_back(area_vector(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]));
    }
    add_up_smooth(areas, groups);
    const glm::vec3& position = mesh.positions[stars[i].first];
    if (areas.empty()) parts.push_back({position, glm::dvec3(0.0)});
    for (const glm::dvec3& area : areas) parts.push_back({position, area});
  }
}

std::vector<BorderVertex> join(std::vector<Part> parts, std::vector<glm::vec3>& normals) {
  std::stable_sort(parts.begin(), parts.end(),
                   [](const Part& x, const Part& y) { return is_before(x.position, y.position); });
  std::vector<BorderVertex> vertices;
  std::vector<glm::dvec3> areas;
  DisjointSets groups;
  for (std::size_t i = 0, end = 0; i < parts.size(); i = end) {
    areas.clear();
    for (; end < parts.size() && parts[end].position == parts[i].position; ++end) areas.push_back(parts[end].area);
    add_up_smooth(areas, groups);
    BorderVertex& vertex = vertices.emplace_back();
    vertex.position = parts[i].position;
    vertex.first_normal = static_cast<std::uint32_t>(normals.size());
    for (const glm::dvec3& area : areas)
      if (const double length = glm::length(area); length > 0.0) normals.emplace_back(area / length);
    vertex.normal_count = static_cast<std::uint32_t>(normals.size()) - vertex.first_normal;
  }
  return vertices;
}

// Returns the place of the first vertex that is not before the position.
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
  vertices_ = join(std::move(parts), normals_);
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

namespace {

bool has_area(const TriangleMesh& mesh, const Triangle& t) {
  const glm::vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
  return a != b && b != c && c != a;
}

// Drops the vertices that no triangle uses; the others keep their order. Nodes have some where the input has seams:
// they are there for vertices of finer nodes to slide to.
void drop_unused_vertices(TriangleMesh& mesh) {
  std::vector<VertexId> place(mesh.positions.size(), no_id);
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) place[t[k]] = 0;
  VertexId used = 0;
  for (VertexId& p : place)
    if (p != no_id) p = used++;
  if (used == place.size()) return;
  const auto keep_used = [&](auto& values) {
    if (values.empty()) return;
    for (std::size_t v = 0; v < place.size(); ++v)
      if (place[v] != no_id) values[place[v]] = values[v];
    values.resize(used);
  };
  keep_used(mesh.positions);
  keep_used(mesh.normals);
  keep_used(mesh.colors);
  keep_used(mesh.texture_coordinates);
  for (Triangle& t : mesh.triangles) t = {place[t.x], place[t.y], place[t.z]};
}

void take_materials(TriangleMesh& mesh, const hlod::NodeMesh& node) {
  if (node.materials.empty()) return;
  for (const Triangle& t : mesh.triangles) mesh.triangle_materials.push_back(node.materials[t.x]);
}

// Uses that normal of all nodes at a border vertex which is nearest to the node's own, if it is within crease_deg.
void take_border_normals(TriangleMesh& mesh, const BorderVertices& borders) {
  const float min_cosine = static_cast<float>(std::cos(crease_deg * 0.017453292519943295));
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const BorderVertex* border = borders.at(mesh.positions[v]);
    if (border == nullptr) continue;
    const glm::vec3 own = mesh.normals[v];
    float nearest = min_cosine;
    for (const glm::vec3& normal : borders.normals(*border))
      if (const float cosine = glm::dot(own, normal); cosine >= nearest) {
        nearest = cosine;
        mesh.normals[v] = normal;
      }
  }
}

// Sets the feature of each triangle of a node. Returns which features of the HLOD they are.
std::vector<FeatureId> take_features(TriangleMesh& mesh, std::span<const hlod::FeatureRun> runs) {
  std::vector<FeatureId> features;
  for (const hlod::FeatureRun& run : runs) features.push_back(run.feature);
  std::sort(features.begin(), features.end());
  features.erase(std::unique(features.begin(), features.end()), features.end());
  mesh.feature_names.resize(features.size());
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto own = std::lower_bound(features.begin(), features.end(), runs[i].feature) - features.begin();
    const std::size_t end = i + 1 < runs.size() ? runs[i + 1].first_triangle : mesh.triangles.size();
    mesh.triangle_features.resize(end, static_cast<FeatureId>(own));
  }
  return features;
}

// Replaces the texture coordinates of vertices that show the node's own image by their places in it.
void lead_to_own_image(std::vector<glm::vec2>& coordinates, const hlod::HlodView& view, const hlod::NodeMesh& node) {
  for (std::size_t v = 0; v < coordinates.size(); ++v) {
    const std::optional<glm::vec2> place = hlod::image_place(view, node, v);
    if (place) coordinates[v] = {place->x, view.texture_origin == TextureOrigin::top_left ? place->y : 1.0F - place->y};
  }
}

// Drops triangles with two corners at one place.
void drop_flat_triangles(TriangleMesh& mesh) {
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!has_area(mesh, mesh.triangles[t])) continue;
    if (!mesh.triangle_features.empty()) mesh.triangle_features[kept] = mesh.triangle_features[t];
    mesh.triangles[kept++] = mesh.triangles[t];
  }
  mesh.triangles.resize(kept);
  if (!mesh.triangle_features.empty()) mesh.triangle_features.resize(kept);
}

}  // namespace

std::vector<Triangle> triangles_of(const hlod::NodeMesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.indices.size() / 3);
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    triangles.emplace_back(mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]);
  return triangles;
}

TileMesh tile_mesh(const hlod::Hlod& hlod, hlod::NodeId n, const BorderVertices& borders) {
  const hlod::NodeMesh node = hlod.mesh(n);
  TriangleMesh mesh;
  mesh.positions.assign(node.positions.begin(), node.positions.end());
  mesh.normals.assign(node.normals.begin(), node.normals.end());
  mesh.colors.assign(node.colors.begin(), node.colors.end());
  mesh.texture_coordinates.assign(node.texture_coordinates.begin(), node.texture_coordinates.end());
  if (!node.image.empty()) lead_to_own_image(mesh.texture_coordinates, hlod.data(), node);
  mesh.triangles = triangles_of(node);
  mesh.materials.resize(hlod.data().materials.size());
  std::vector<FeatureId> features = take_features(mesh, hlod.features(n));
  if (!mesh.normals.empty()) {
    take_materials(mesh, node);
    drop_unused_vertices(mesh);
    return {.mesh = std::move(mesh), .features = std::move(features)};
  }
  drop_flat_triangles(mesh);
  if (mesh.triangles.empty()) return {};
  take_materials(mesh, node);
  // Normals are smooth across seams of textures, where vertices become wedges of one vertex.
  if (hlod.data().has_seams) mesh = clean(std::move(mesh), {}, "tile").mesh;
  mesh = part_features(crease_normals(mesh, crease_deg));
  if (!mesh.corners.empty()) mesh.triangles = std::move(mesh.corners);
  mesh.corners.clear();
  mesh.extra_wedges.clear();
  take_border_normals(mesh, borders);
  return {.mesh = std::move(mesh), .features = std::move(features)};
}

namespace {

class SkirtMaker {
 public:
  SkirtMaker(TileMesh& tile, double depth)
      : tile_(tile),
        mesh_(tile.mesh),
        depth_(depth),
        first_(first_at_position(mesh_.positions)),
        areas_(area_sums(mesh_.positions, mesh_.triangles, first_)),
        hem_(mesh_.positions.size(), no_id) {}

  void run(const BorderVertices& borders) {
    const auto is_inputs = [&](VertexId v) {
      const BorderVertex* border = borders.at(mesh_.positions[v]);
      return border != nullptr && border->is_at_input_border;
    };
    for (const BorderEdge& edge : border_edges(mesh_.triangles, first_)) {
      if (is_inputs(edge.from) && is_inputs(edge.to)) continue;
      const VertexId from = hem(edge.from), to = hem(edge.to);
      // The winding is that of a neighbour across the edge, so the skirt faces away from the tile.
      mesh_.triangles.emplace_back(edge.to, edge.from, from);
      mesh_.triangles.emplace_back(edge.to, from, to);
      tile_.skirt_triangles += 2;
      if (!mesh_.triangle_materials.empty())
        mesh_.triangle_materials.insert(mesh_.triangle_materials.end(), 2, mesh_.triangle_materials[edge.triangle]);
      if (!mesh_.triangle_features.empty())
        mesh_.triangle_features.insert(mesh_.triangle_features.end(), 2, mesh_.triangle_features[edge.triangle]);
    }
  }

 private:
  // Returns the vertex below v, with the attributes of v.
  VertexId hem(VertexId v) {
    if (hem_[v] != no_id) return hem_[v];
    hem_[v] = static_cast<VertexId>(mesh_.positions.size());
    const glm::dvec3 area = areas_[first_[v]];
    const double length = glm::length(area);
    const glm::dvec3 inwards = length > 0.0 ? -area / length : glm::dvec3(0.0);
    constexpr double farthest = farthest_coordinate;
    mesh_.positions.emplace_back(
        glm::clamp(glm::dvec3(mesh_.positions[v]) + depth_ * inwards, glm::dvec3(-farthest), glm::dvec3(farthest)));
    repeat(mesh_.normals, v);
    repeat(mesh_.colors, v);
    repeat(mesh_.texture_coordinates, v);
    return hem_[v];
  }

  template <typename T>
  static void repeat(std::vector<T>& attributes, VertexId v) {
    if (attributes.empty()) return;
    const T attribute = attributes[v];
    attributes.push_back(attribute);
  }

  TileMesh& tile_;
  TriangleMesh& mesh_;
  double depth_;
  std::vector<std::uint32_t> first_;
  std::vector<glm::dvec3> areas_;
  std::vector<VertexId> hem_;  // per vertex of the node, the one below it
};

}  // namespace

void add_skirts(TileMesh& tile, double depth, const BorderVertices& borders) { SkirtMaker(tile, depth).run(borders); }

}  // namespace occlod::tiles
