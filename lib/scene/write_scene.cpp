// The format is described in docs/guide/scenes.md.
#include <nlohmann/json.hpp>
#include <string>

#include "base/atomic_file.h"
#include "occlod/core/error.h"
#include "occlod/scene/scene.h"
#include "scene/check_path.h"

namespace occlod {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Json source_json(const MeshFile& file) { return {{"mesh", file.names}}; }
Json source_json(const RoughPlanetOptions& o) {
  return {{"generator", "rough-planet"},
          {"options",
           {{"level", o.level},
            {"seed", o.seed},
            {"amplitude", o.amplitude},
            {"frequency", o.frequency},
            {"octaves", o.octaves}}}};
}
Json source_json(const CityOptions& o) {
  return {{"generator", "city"},
          {"options", {{"blocks", o.blocks}, {"facade_cells", o.facade_cells}, {"seed", o.seed}}}};
}
Json source_json(const PipesOptions& o) {
  return {{"generator", "pipes"},
          {"options", {{"pipes", o.pipes}, {"bends", o.bends}, {"sides", o.sides}, {"seed", o.seed}}}};
}
Json source_json(const PlantOptions& o) {
  return {{"generator", "plant"},
          {"options",
           {{"storeys", o.storeys},
            {"bays", o.bays},
            {"pipes", o.pipes},
            {"bends", o.bends},
            {"sides", o.sides},
            {"seed", o.seed}}}};
}
Json source_json(const SpheresBehindWallOptions& o) {
  return {{"generator", "spheres-behind-wall"},
          {"options", {{"spheres", o.spheres}, {"level", o.level}, {"wall_cells", o.wall_cells}, {"seed", o.seed}}}};
}

Json object_json(const SceneObject& object) {
  Json json = std::visit([](const auto& source) { return source_json(source); }, object.source);
  Json matrix = Json::array();
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) matrix.push_back(object.object_to_world[column][row]);
  json["matrix"] = std::move(matrix);
  json["two_sided"] = object.two_sided;
  if (!object.attributes) json["attributes"] = false;
  return json;
}

Json camera_json(const Camera& camera) {
  Json json = {{"eye", vector_json(camera.eye)},
               {"target", vector_json(camera.target)},
               {"up", vector_json(camera.up)},
               {"near", camera.near},
               {"far", camera.far},
               {"width", camera.width},
               {"height", camera.height}};
  if (camera.orthographic_height)
    json["orthographic_height"] = *camera.orthographic_height;
  else
    json["fov_y_deg"] = camera.fov_y_deg;
  return json;
}

Json path_json(const CameraPath& path) {
  Json keys = Json::array();
  for (const Camera& key : path.keys) keys.push_back(camera_json(key));
  Json json = {{"frames", path.frames}, {"keys", std::move(keys)}};
  if (path.jump) json["jump"] = true;
  return json;
}

Json cells_json(const SceneCells& cells) {
  Json json = Json::object();
  for (const CellBox& region : cells.regions)
    json["regions"].push_back({{"min", vector_json(region.min)}, {"max", vector_json(region.max)}});
  if (cells.root_cell) json["root_cell"] = *cells.root_cell;
  if (cells.smallest_cell) json["smallest_cell"] = *cells.smallest_cell;
  if (cells.most_triangles) json["most_triangles"] = *cells.most_triangles;
  return json;
}

}  // namespace

void write_scene(const std::filesystem::path& path, const SceneDescription& scene) {
  if (scene.objects.empty()) throw Error({path.string(), "", "would have no objects", "open a mesh first"});
  if (!scene.cameras.contains("default"))
    throw Error({path.string(), "", "would have no camera \"default\"", "name the camera to start with"});
  for (const auto& [name, camera_path] : scene.paths)
    if (const auto bad = find_bad_frame(camera_path))
      throw Error({path.string(), "/paths/" + name, bad->text(), BadFrame::remedy});
  Json document = Json::object();
  if (!scene.about.empty()) document["about"] = scene.about;
  for (const SceneObject& object : scene.objects) document["objects"].push_back(object_json(object));
  for (const auto& [name, camera] : scene.cameras) document["cameras"][name] = camera_json(camera);
  for (const auto& [name, camera_path] : scene.paths) document["paths"][name] = path_json(camera_path);
  if (scene.cells) document["cells"] = cells_json(*scene.cells);
  AtomicFile file(path);
  file.stream() << document.dump(1) << '\n';
  file.commit();
}

}  // namespace occlod
