#include <algorithm>
#include <cctype>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/type_ptr.hpp>
#include <glm/trigonometric.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "base/atomic_file.h"
#include "base/strict_json.h"
#include "mesh/generators.h"
#include "occlod/base.h"
#include "occlod/scene.h"
#include "occlod/view.h"
#include "scene/check_path.h"

namespace occlod {

namespace fs = std::filesystem;

bool is_scene_file(const fs::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".json";
}

SceneDescription describe_file(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (!fs::exists(status)) throw Error({path.string(), "", "no such file", "check the path"});
  if (fs::is_directory(status))
    throw Error({path.string(), "", "is a folder", "name a scene (.json), a mesh or a hierarchy (.olod) in it"});
  if (!fs::is_regular_file(status))
    throw Error({path.string(), "", "is not a regular file", "save it to a file first"});
  if (is_scene_file(path)) return read_scene(path);
  SceneDescription scene;
  scene.name = path.stem().string();
  scene.file = path;
  scene.objects.push_back({.source = MeshFile{{fs::absolute(path).string()}}});
  return scene;
}

// Reads scene files. docs/guide/scenes.md describes the format.

namespace {

void read_into(double& target, const JsonPlace& options, const char* key) {
  if (const auto place = options.find(key)) target = place->number();
}

GeneratorValues read_values(const JsonPlace& options, std::span<const GeneratorParameter> parameters) {
  GeneratorValues values;
  for (const auto& [name, place] : options.members()) {
    const GeneratorParameter* const parameter = find_named(parameters, name);
    if (parameter == nullptr) place.fail("is not a known key", "use one of: " + names_of(parameters));
    const double value = place.number();
    if (!parameter->accepts(value)) place.fail("is not " + accepted_by(*parameter));
    values.emplace(name, value);
  }
  return values;
}

GeneratedMesh read_generator(const JsonPlace& object) {
  const JsonPlace place = object.at("generator");
  const std::string name = place.string();
  const Generator* const generator = find_named(generators(), name);
  if (generator == nullptr) place.fail("is not a generator", "use one of: " + names_of(generators()));
  GeneratedMesh mesh{name, {}};
  if (const auto options = object.find("options")) mesh.values = read_values(*options, generator->parameters);
  return mesh;
}

MeshFile read_mesh_file(const JsonPlace& mesh) {
  if (mesh.is_string()) return {{mesh.string()}};
  MeshFile file;
  for (const JsonPlace& name : mesh.elements()) file.names.push_back(name.string());
  return file;
}

MeshSource read_source(const JsonPlace& object) {
  const bool has_mesh = object.has("mesh");
  if (has_mesh == object.has("generator")) object.fail("needs either \"mesh\" or \"generator\"", "give one of them");
  if (!has_mesh) return read_generator(object);
  if (const auto options = object.find("options")) options->fail("is only for generators", "remove it");
  return read_mesh_file(object.at("mesh"));
}

glm::dvec3 read_vector(const JsonPlace& place) {
  const std::vector<double> numbers = place.numbers(3);
  return {numbers[0], numbers[1], numbers[2]};
}

glm::dmat4 read_matrix(const JsonPlace& place) {
  const std::vector<double> numbers = place.numbers(16);
  const glm::dmat4 matrix = glm::make_mat4(numbers.data());
  if (glm::dvec4(matrix[0].w, matrix[1].w, matrix[2].w, matrix[3].w) != glm::dvec4(0.0, 0.0, 0.0, 1.0))
    place.fail("is not affine: elements 3, 7, 11, 15 are not 0, 0, 0, 1", "give the matrix by columns");
  if (glm::determinant(glm::dmat3(matrix)) == 0.0) place.fail("cannot be inverted", "scale by something other than 0");
  return matrix;
}

glm::dmat4 read_rotation(const JsonPlace& place) {
  place.expect_keys({"axis", "degrees"});
  const glm::dvec3 axis = read_vector(place.at("axis"));
  if (!(glm::length(axis) > 0.0)) place.at("axis").fail("has no length", "give the axis to turn around");
  return glm::rotate(glm::dmat4(1.0), glm::radians(place.at("degrees").number()), axis);
}

// Combines the transforms: scale first, then rotation, then translation.
glm::dmat4 read_placement(const JsonPlace& object) {
  if (const auto matrix = object.find("matrix")) {
    for (const char* key : {"position", "rotation", "scale"})
      if (const auto other = object.find(key)) other->fail("cannot be combined with \"matrix\"", "remove one of them");
    return read_matrix(*matrix);
  }
  glm::dmat4 result(1.0);
  if (const auto position = object.find("position")) result = glm::translate(result, read_vector(*position));
  if (const auto rotation = object.find("rotation")) result *= read_rotation(*rotation);
  if (const auto scale = object.find("scale")) {
    const double factor = scale->number();
    if (factor == 0.0) scale->fail("is 0", "give the size relative to the mesh's own");
    result = glm::scale(result, glm::dvec3(factor));
  }
  return result;
}

SceneObject read_object(const JsonPlace& object) {
  object.expect_keys(
      {"mesh", "generator", "options", "matrix", "position", "rotation", "scale", "two_sided", "attributes"});
  SceneObject result;
  result.source = read_source(object);
  result.object_to_world = read_placement(object);
  if (const auto two_sided = object.find("two_sided")) result.two_sided = two_sided->boolean();
  if (const auto attributes = object.find("attributes")) result.attributes = attributes->boolean();
  return result;
}

Camera read_camera(const JsonPlace& place) {
  place.expect_keys(
      {"eye", "target", "up", "fov_y_deg", "near", "far", "width", "height", "orthographic_height", "principal_point"});
  Camera camera;
  camera.eye = read_vector(place.at("eye"));
  camera.target = read_vector(place.at("target"));
  if (const auto up = place.find("up")) camera.up = read_vector(*up);
  read_into(camera.fov_y_deg, place, "fov_y_deg");
  read_into(camera.near, place, "near");
  read_into(camera.far, place, "far");
  if (const auto height = place.find("orthographic_height")) {
    if (const auto angle = place.find("fov_y_deg"))
      angle->fail("cannot be combined with \"orthographic_height\"", "remove one of them");
    camera.orthographic_height = height->number();
  }
  if (const auto point = place.find("principal_point")) {
    const std::vector<double> numbers = point->numbers(2);
    camera.principal_point = {numbers[0], numbers[1]};
  }
  if (const auto width = place.find("width")) camera.width = width->integer(1);
  if (const auto height = place.find("height")) camera.height = height->integer(1);
  try {
    const View check(camera);
  } catch (const Error& error) {
    place.fail(error.diagnosis().place + " " + error.diagnosis().problem, error.diagnosis().remedy);
  }
  return camera;
}

CameraPath read_path(const JsonPlace& place) {
  place.expect_keys({"frames", "keys", "jump"});
  CameraPath path;
  path.frames = place.at("frames").integer(1);
  for (const JsonPlace& key : place.at("keys").elements()) path.keys.push_back(read_camera(key));
  if (const auto jump = place.find("jump")) path.jump = jump->boolean();
  const auto is_orthographic = [](const Camera& key) { return key.orthographic_height.has_value(); };
  const auto parallel = std::count_if(path.keys.begin(), path.keys.end(), is_orthographic);
  if (!path.jump && parallel != 0 && parallel != std::ssize(path.keys))
    place.at("keys").fail("mix perspective and orthographic cameras, which cannot be interpolated",
                          "give all keys an orthographic_height or none, or set \"jump\": true");
  if (path.jump && path.keys.size() < 2)
    place.at("keys").fail("has only one key, so that there is nothing to jump to", "add a key");
  if (path.jump && path.keys.size() > static_cast<std::size_t>(path.frames))
    place.at("frames").fail("is less than the number of keys, each of which needs a frame",
                            "give more frames or fewer keys");
  if (const auto bad = find_bad_frame(path)) place.fail(bad->text(), BadFrame::remedy);
  return path;
}

CellBox read_region(const JsonPlace& place) {
  place.expect_keys({"min", "max"});
  const CellBox box{read_vector(place.at("min")), read_vector(place.at("max"))};
  for (int axis = 0; axis < 3; ++axis)
    if (box.max[axis] < box.min[axis]) place.fail("has a max below its min", "swap the two");
  return box;
}

std::optional<double> read_length(const JsonPlace& cells, const char* key) {
  const auto place = cells.find(key);
  if (!place) return std::nullopt;
  const double length = place->number();
  if (!(length > 0.0)) place->fail("is not a length", "give a number of world units > 0");
  return length;
}

SceneCells read_cells(const JsonPlace& place) {
  place.expect_keys({"regions", "root_cell", "smallest_cell", "max_triangles"});
  SceneCells cells;
  for (const JsonPlace& region : place.at("regions").elements()) cells.regions.push_back(read_region(region));
  cells.root_cell = read_length(place, "root_cell");
  cells.smallest_cell = read_length(place, "smallest_cell");
  if (cells.root_cell && cells.smallest_cell && *cells.smallest_cell > *cells.root_cell)
    place.at("smallest_cell").fail("is more than \"root_cell\"", "give a smaller one");
  if (const auto most = place.find("max_triangles")) {
    cells.max_triangles = most->unsigned_integer();
    if (*cells.max_triangles == 0) most->fail("is 0", "give a number of triangles");
  }
  return cells;
}

}  // namespace

SceneDescription read_scene(const std::filesystem::path& path) {
  const nlohmann::json document = parse_json_file(path);
  const std::string file = path.string();
  const JsonPlace root(document, file);
  root.expect_keys({"about", "objects", "cameras", "paths", "cells"});

  SceneDescription scene;
  scene.name = path.stem().string();
  scene.file = path;
  if (const auto about = root.find("about")) scene.about = about->string();
  for (const JsonPlace& object : root.at("objects").elements()) scene.objects.push_back(read_object(object));
  for (const auto& [name, place] : root.at("cameras").members()) scene.cameras.emplace(name, read_camera(place));
  if (!scene.cameras.contains("default"))
    root.at("cameras").fail("has no \"default\"", "name the camera to start with");
  if (const auto paths = root.find("paths"))
    for (const auto& [name, place] : paths->members()) scene.paths.emplace(name, read_path(place));
  if (const auto cells = root.find("cells")) scene.cells = read_cells(*cells);
  return scene;
}

// Writes scene files. docs/guide/scenes.md describes the format.

namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

Json source_json(const MeshFile& file) { return {{"mesh", file.names}}; }
Json source_json(const GeneratedMesh& mesh) {
  const Generator& generator = generator_of(mesh.generator);
  const GeneratorValues values = complete_values(generator, mesh.values);
  Json options;
  for (const GeneratorParameter& parameter : generator.parameters) {
    const std::string name(parameter.name);
    if (parameter.whole)
      options[name] = value_of<std::uint64_t>(values, name);
    else
      options[name] = value_of<double>(values, name);
  }
  return {{"generator", mesh.generator}, {"options", options}};
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
  if (camera.principal_point != glm::dvec2(0.0))
    json["principal_point"] = {camera.principal_point.x, camera.principal_point.y};
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
  if (cells.max_triangles) json["max_triangles"] = *cells.max_triangles;
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
  std::string text;
  try {
    text = document.dump(1);
  } catch (const Json::exception&) {
    throw Error({path.string(), "", "would have a name that is not UTF-8, which JSON cannot hold", "rename that file"});
  }
  AtomicFile file(path);
  file.stream() << text << '\n';
  file.commit();
}

}  // namespace occlod
