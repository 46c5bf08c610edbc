// Meshes whose coordinates are those of a map, that is, of a projected coordinate system, brought to their place on
// Earth by PROJ.
#pragma once

#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <string>

#include "json_output.h"
#include "occlod/hlod.h"
#include "occlod/mesh.h"
#include "occlod/tiles.h"

namespace occlod::tool {

// A projected coordinate system, and a frame on Earth: metres to the east, to the north and up of a place.
class MapSystem {
 public:
  MapSystem() = default;
  MapSystem(const MapSystem&) = delete;
  MapSystem& operator=(const MapSystem&) = delete;
  virtual ~MapSystem() = default;

  // Puts the frame where the system has these coordinates of meshes, of which `up` is the axis of heights: z, with x
  // and y as the system has them on maps, or y, with -z as the map's y. Throws Error where the system does not reach.
  virtual void put_frame(const glm::dvec3& coordinates, UpAxis up) = 0;
  // Brings a mesh, any triangle soup, to the frame: each position by itself, in doubles, and each normal with the
  // surface around it. Triangles turn over where the system is a mirror image. Origin 0, z up; positions may become
  // equal, so clean() the mesh before use. Throws Error for a position that the system does not reach. O(wedges).
  virtual void bring(TriangleMesh& mesh) const = 0;
  // Returns the place of the frame.
  [[nodiscard]] virtual const tiles::GeodeticOrigin& place() const = 0;
  // Returns up, crs, heights, accuracy_m where it is known, longitude_deg, latitude_deg and height_m.
  [[nodiscard]] virtual Json told() const = 0;
};

// Returns the system that PROJ has by this name, such as EPSG:32633, or EPSG:32633+5773 with a system of heights. Other
// heights are above the WGS84 ellipsoid, in the unit of x and y. Throws CLI::ValidationError for a name that stands for
// no projected system, for one that PROJ cannot bring to WGS84, and in a build without PROJ. `subject` names the mesh
// in errors; `threads` is as for clean().
[[nodiscard]] std::unique_ptr<MapSystem> find_map_system(const std::string& name, const std::string& subject,
                                                         int threads);

// Puts the frame in the middle of the mesh's box, and brings the mesh there. `up` overrules the mesh's own.
[[nodiscard]] CleanMesh brought(CleanMesh input, MapSystem& system, std::optional<UpAxis> up, int threads);

// Does the same piece by piece, to the same bytes; `source` is read once more before, for the box. `system` must
// outlive the result.
[[nodiscard]] hlod::TriangleSource brought(hlod::TriangleSource source, MapSystem& system, std::optional<UpAxis> up);

}  // namespace occlod::tool
