// The objects of the scene that is shown.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "layered_texture.h"
#include "occlod/bounds.h"
#include "occlod/device.h"
#include "occlod/hierarchy.h"
#include "occlod/hlod.h"
#include "occlod/scene.h"

namespace occlod::viewer {

// A hierarchy and what is drawn with it, computed once. Immutable.
struct ViewMesh {
  std::shared_ptr<const Hierarchy> hierarchy;
  std::vector<glm::vec3> normals;     // by wedge: the file's own, else of the full mesh
  std::vector<std::uint8_t> creases;  // by wedge: see find_creases()
  std::vector<std::uint16_t> levels;  // by split: how deep it stands in the forest
  int level_count = 0;
  Sphere sphere;                                  // around all vertices and the middle of their box
  std::shared_ptr<const LayeredTexture> texture;  // null without materials
};

// folder: where the names of images start. Images that are missing are told of on standard error. Throws Error when
// part of the hierarchy is damaged. O(size).
[[nodiscard]] std::shared_ptr<const ViewMesh> make_view_mesh(std::shared_ptr<const Hierarchy> hierarchy,
                                                             const std::filesystem::path& folder = {});

// An HLOD, likewise.
struct ViewHlod {
  std::shared_ptr<const hlod::Hlod> hlod;         // whose meshes have been checked, or come and go
  Sphere sphere;                                  // around all vertices, or their box, and the middle of it
  std::shared_ptr<const LayeredTexture> texture;  // null without materials
};

// folder: as above. O(size). Throws Error when a mesh of the HLOD is damaged.
[[nodiscard]] std::shared_ptr<const ViewHlod> make_view_hlod(std::shared_ptr<const hlod::Hlod> hlod,
                                                             const std::filesystem::path& folder = {});

// Scaled, turned around x, then y, then z, moved. `shape` comes before it all: what is no such placement, e.g. a shear.
struct Placement {
  glm::dvec3 position{0.0};
  glm::dvec3 rotation_deg{0.0};
  double scale = 1.0;
  glm::dmat3 shape{1.0};
};
[[nodiscard]] Placement placement_of(const glm::dmat4& object_to_world);
[[nodiscard]] glm::dmat4 matrix_of(const Placement& placement);

struct PlacedObject {
  std::uint64_t id = 0;                  // unique in a session
  std::string name;                      // for people
  std::vector<SceneObject> parts;        // what it was made of, placed in object space; HLODs may have several
  std::shared_ptr<const ViewMesh> mesh;  // null for an HLOD
  std::shared_ptr<const ViewHlod> hlod;  // null for a mesh
  glm::dmat4 object_to_world{1.0};       // exactly as loaded until `placement` is edited
  Placement placement;
  bool two_sided = false;
  bool attributes = true;  // how far these slip counts as an error too: see RefineObject
  bool shown = true;
};

using Objects = std::vector<PlacedObject>;  // all meshes, or all HLODs

[[nodiscard]] inline bool are_hlods(const Objects& objects) { return !objects.empty() && objects[0].hlod != nullptr; }
// Null without materials.
[[nodiscard]] inline const std::shared_ptr<const LayeredTexture>& texture_of(const PlacedObject& object) {
  return object.hlod ? object.hlod->texture : object.mesh->texture;
}
// For traversal. The objects keep what these refer to.
[[nodiscard]] std::vector<hlod::PlacedHlod> placed_hlods(const Objects& objects);
// Object space.
[[nodiscard]] const Box& box_of(const PlacedObject& object);

// A sphere around all that are shown, in world space; radius 1 around the origin when there are none.
struct SceneBounds {
  glm::dvec3 center{0.0};
  double radius = 1.0;
};
[[nodiscard]] SceneBounds bounds_of(const Objects& objects);
[[nodiscard]] SceneBounds bounds_of(const PlacedObject& object);
// True when the box of one that is shown holds the point, given in world space.
[[nodiscard]] bool any_box_holds(const Objects& objects, const glm::dvec3& point);

}  // namespace occlod::viewer
