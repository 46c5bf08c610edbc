#include "objects.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "creases.h"
#include "object_textures.h"
#include "occlod/build_hierarchy.h"

namespace occlod::viewer {
namespace {

std::vector<glm::vec3> vertex_normals(std::span<const glm::vec3> positions, std::span<const Triangle> triangles) {
  std::vector<glm::vec3> normals(positions.size(), glm::vec3(0.0F));
  for (const Triangle& t : triangles) {
    const glm::vec3 weighted = glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x]);
    for (int k = 0; k < 3; ++k) normals[t[k]] += weighted;
  }
  for (glm::vec3& normal : normals) {
    const float length = glm::length(normal);
    normal = length > 0.0F ? normal / length : glm::vec3(0.0F, 0.0F, 1.0F);
  }
  return normals;
}

// Gives the other wedges of a vertex the value of its first one.
template <typename Value>
std::vector<Value> by_wedge(const Hierarchy& hierarchy, std::vector<Value> values) {
  for (const VertexId v : hierarchy.data().extra_wedges) values.push_back(Value(values[v]));
  return values;
}

glm::dmat3 rotation_of(const glm::dvec3& degrees) {
  const glm::dvec3 r = glm::radians(degrees);
  glm::dmat4 m(1.0);
  m = glm::rotate(m, r.z, {0.0, 0.0, 1.0});
  m = glm::rotate(m, r.y, {0.0, 1.0, 0.0});
  return glm::dmat3(glm::rotate(m, r.x, {1.0, 0.0, 0.0}));
}

// Returns the angles of a rotation Rz * Ry * Rx.
glm::dvec3 angles_of(const glm::dmat3& m) {
  // Adding 0 turns -0 into 0.
  const double y = 0.0 + std::asin(std::clamp(-m[0][2], -1.0, 1.0));
  if (std::abs(m[0][2]) > 1.0 - 1e-12)  // x and z turn around the same axis
    return glm::degrees(glm::dvec3(0.0, y, std::atan2(-m[1][0], m[1][1])));
  return glm::degrees(glm::dvec3(std::atan2(m[1][2], m[2][2]), y, std::atan2(m[0][1], m[0][0])));
}

// Surrounds all vertices, or the box if not all meshes are loaded. Throws Error when a mesh is damaged.
Sphere sphere_around(const hlod::Hlod& hlod) {
  const Box& box = hlod.data().box;
  Sphere sphere{0.5F * box.min + 0.5F * box.max, 0.0F};
  if (hlod.store() != nullptr) return {sphere.center, glm::distance(sphere.center, box.max)};
  const hlod::Level& finest = hlod.data().levels[0];
  for (hlod::NodeId n = finest.first_node; n < finest.first_node + finest.node_count; ++n) {
    hlod.require(n);
    for (const glm::vec3& p : hlod.mesh(n).positions)
      sphere.radius = std::max(sphere.radius, glm::distance(sphere.center, p));
  }
  return sphere;
}

}  // namespace

std::shared_ptr<const ViewMesh> make_view_mesh(std::shared_ptr<const Hierarchy> hierarchy,
                                               const std::filesystem::path& folder, const ImageNote& note) {
  hierarchy->require_all();
  auto mesh = std::make_shared<ViewMesh>();
  // Triangles name vertices, because seams are not borders of the surface.
  const std::vector<Triangle> triangles = triangles_of(*hierarchy, full_cut(*hierarchy));
  const std::span<const glm::vec3> positions = hierarchy->positions().first(hierarchy->vertex_count());
  const std::span<const glm::vec3> own = hierarchy->data().normals;
  mesh->normals = own.empty() ? by_wedge(*hierarchy, vertex_normals(positions, triangles))
                              : std::vector<glm::vec3>(own.begin(), own.end());
  mesh->creases = by_wedge(*hierarchy, find_creases(positions, triangles));
  const tool::ObjectTextures textures(hierarchy->data(), folder, tool::TextureChoice::automatic, note);
  mesh->texture = layered(textures.materials(), hierarchy->data().texture_origin);
  const Box& box = hierarchy->box();
  mesh->sphere.center = 0.5F * box.min + 0.5F * box.max;
  for (const glm::vec3& p : hierarchy->positions())
    mesh->sphere.radius = std::max(mesh->sphere.radius, glm::distance(mesh->sphere.center, p));
  mesh->levels.resize(hierarchy->split_count());
  for (SplitId s = 0; s < hierarchy->split_count(); ++s) {
    const SplitId parent = hierarchy->node(s).parent;  // less than s
    const int level = parent == no_id ? 0 : mesh->levels[parent] + 1;
    mesh->levels[s] = static_cast<std::uint16_t>(std::min(level, 0xFFFF));
    mesh->level_count = std::max(mesh->level_count, level + 1);
  }
  mesh->hierarchy = std::move(hierarchy);
  return mesh;
}

std::shared_ptr<const ViewHlod> make_view_hlod(std::shared_ptr<const hlod::Hlod> hlod,
                                               const std::filesystem::path& folder, const ImageNote& note) {
  auto view = std::make_shared<ViewHlod>();
  const tool::ObjectTextures textures(hlod->data(), folder, tool::TextureChoice::automatic, note);
  view->texture = layered(textures.materials(), hlod->data().texture_origin);
  view->sphere = sphere_around(*hlod);
  view->hlod = std::move(hlod);
  return view;
}

std::vector<hlod::PlacedHlod> placed_hlods(const Objects& objects) {
  std::vector<hlod::PlacedHlod> placed;
  for (const PlacedObject& object : objects)
    placed.push_back({object.hlod->hlod.get(), object.object_to_world, object.two_sided});
  return placed;
}

const Box& box_of(const PlacedObject& object) {
  return object.hlod ? object.hlod->hlod->data().box : object.mesh->hierarchy->box();
}

Placement placement_of(const glm::dmat4& object_to_world) {
  Placement placement;
  placement.position = glm::dvec3(object_to_world[3]);
  const glm::dmat3 linear(object_to_world);
  const double scale = std::cbrt(glm::determinant(linear));
  const glm::dmat3 rotation = linear / scale;
  const glm::dmat3 rest = glm::transpose(rotation) * rotation - glm::dmat3(1.0);
  const double off = std::max({glm::length(rest[0]), glm::length(rest[1]), glm::length(rest[2])});
  if (off < 1e-9) {
    placement.scale = scale;
    placement.rotation_deg = angles_of(rotation);
  } else {
    placement.shape = linear;
  }
  return placement;
}

glm::dmat4 matrix_of(const Placement& placement) {
  glm::dmat4 matrix(rotation_of(placement.rotation_deg) * placement.scale * placement.shape);
  matrix[3] = glm::dvec4(placement.position, 1.0);
  return matrix;
}

SceneBounds bounds_of(const Objects& objects) {
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec3 high = -low;
  for (const PlacedObject& object : objects) {
    if (!object.shown) continue;
    const SceneBounds one = bounds_of(object);
    low = glm::min(low, one.center - one.radius);
    high = glm::max(high, one.center + one.radius);
  }
  if (!(low.x <= high.x)) return {};
  SceneBounds all{(low + high) / 2.0, 0.0};
  for (const PlacedObject& object : objects) {
    if (!object.shown) continue;
    const SceneBounds one = bounds_of(object);
    all.radius = std::max(all.radius, glm::length(one.center - all.center) + one.radius);
  }
  return all;
}

SceneBounds bounds_of(const PlacedObject& object) {
  const glm::dmat3 linear(object.object_to_world);
  // This is exact for placements, and otherwise at least the largest stretch.
  double stretch = std::max({glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2])});
  if (object.placement.shape != glm::dmat3(1.0)) stretch *= std::sqrt(3.0);
  const Sphere& sphere = object.hlod ? object.hlod->sphere : object.mesh->sphere;
  return {glm::dvec3(object.object_to_world * glm::dvec4(sphere.center, 1.0)),
          std::max(static_cast<double>(sphere.radius) * stretch, 1e-30)};
}

bool any_box_holds(const Objects& objects, const glm::dvec3& point) {
  return std::any_of(objects.begin(), objects.end(), [&](const PlacedObject& object) {
    const Box& box = box_of(object);
    const glm::vec3 p(glm::inverse(object.object_to_world) * glm::dvec4(point, 1.0));
    return object.shown && glm::all(glm::greaterThan(p, box.min)) && glm::all(glm::lessThan(p, box.max));
  });
}

}  // namespace occlod::viewer
