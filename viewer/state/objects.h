// Holds the objects of the shown scene.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
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

// Holds a hierarchy with what drawing it needs, computed once. Immutable.
struct ViewMesh {
  std::shared_ptr<const Hierarchy> hierarchy;
  std::vector<glm::vec3> normals;     // per wedge: the file's own, else those of the full mesh
  std::vector<std::uint8_t> creases;  // per wedge: see find_creases()
  std::vector<std::uint16_t> levels;  // per split, its depth in the forest
  int level_count = 0;
  Sphere sphere;                                  // around all vertices and the middle of their box
  std::shared_ptr<const LayeredTexture> texture;  // null without materials
};

// Is told one line about each image that is missing.
using ImageNote = std::function<void(const std::string& line)>;

// Computes it. `folder` is where the names of images start. Throws Error when part of the hierarchy is damaged.
// O(size).
[[nodiscard]] std::shared_ptr<const ViewMesh> make_view_mesh(std::shared_ptr<const Hierarchy> hierarchy,
                                                             const std::filesystem::path& folder = {},
                                                             const ImageNote& note = {});

// Holds an HLOD with what drawing it needs.
struct ViewHlod {
  std::shared_ptr<const hlod::Hlod> hlod;         // its meshes have been checked, or are loaded on demand
  Sphere sphere;                                  // around all vertices, or their box, and the middle of it
  std::shared_ptr<const LayeredTexture> texture;  // null without materials
};

// Computes it. `folder` is where the names of images start. O(size). Throws Error when a mesh of the HLOD is damaged.
[[nodiscard]] std::shared_ptr<const ViewHlod> make_view_hlod(std::shared_ptr<const hlod::Hlod> hlod,
                                                             const std::filesystem::path& folder = {},
                                                             const ImageNote& note = {});

// Applies `shape`, scales, turns around x, then y, then z, and moves. `shape` is the rest of the transform, e.g. a
// shear.
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
  bool attributes = true;  // whether their slip counts as an error too: see RefineObject
  bool shown = true;
};

using Objects = std::vector<PlacedObject>;  // all meshes, or all HLODs

[[nodiscard]] inline bool are_hlods(const Objects& objects) { return !objects.empty() && objects[0].hlod != nullptr; }
// Returns null without materials.
[[nodiscard]] inline const std::shared_ptr<const LayeredTexture>& texture_of(const PlacedObject& object) {
  return object.hlod ? object.hlod->texture : object.mesh->texture;
}
// Returns the HLODs for traversal. They refer to the objects.
[[nodiscard]] std::vector<hlod::PlacedHlod> placed_hlods(const Objects& objects);
// Returns the box in object space.
[[nodiscard]] const Box& box_of(const PlacedObject& object);

// Holds a sphere around all shown objects, in world space; radius 1 around the origin if there are none.
struct SceneBounds {
  glm::dvec3 center{0.0};
  double radius = 1.0;
};
[[nodiscard]] SceneBounds bounds_of(const Objects& objects);
[[nodiscard]] SceneBounds bounds_of(const PlacedObject& object);
// Returns whether the box of a shown object contains the point, which is in world space.
[[nodiscard]] bool any_box_holds(const Objects& objects, const glm::dvec3& point);

}  // namespace occlod::viewer
