#include "viewer/support.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <glm/common.hpp>
#include <vector>

#include "mesh/image_codec.h"
#include "occlod/build_cells.h"
#include "occlod/build_hlod.h"
#include "occlod/generate.h"
#include "occlod/node_store.h"
#include "occlod/visibility.h"
#include "view_cells.h"

namespace occlod::viewer::test {

Folder::Folder() {
  std::string name = (std::filesystem::temp_directory_path() / "occlod_viewer_XXXXXX").string();
  folder_ = mkdtemp(name.data());
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

std::filesystem::path Folder::write(const std::string& name, const nlohmann::json& content) const {
  std::ofstream(path(name)) << content.dump(1);
  return path(name);
}

nlohmann::json planet_scene(int level) {
  const nlohmann::json near = {{"eye", {0.0, 1.3, 0.3}}, {"target", {0.0, 1.0, -0.8}}, {"near", 0.01}, {"far", 5.0}};
  const nlohmann::json far = {
      {"eye", {0.0, 0.5, 3.5}}, {"target", {0.0, 0.0, 0.0}}, {"near", 0.5}, {"far", 10.0}, {"width", 320},
      {"height", 240}};
  nlohmann::json beside = far;
  beside["eye"] = {2.5, 0.8, 1.5};
  return {{"objects", {{{"generator", "rough-planet"}, {"options", {{"level", level}}}}}},
          {"cameras", {{"default", near}, {"far", far}}},
          {"paths", {{"by", {{"frames", 5}, {"keys", {far, beside}}}}}}};
}

std::filesystem::path write_city(const Folder& folder) {
  hlod::HlodBuildOptions options;
  options.node_triangles = 64;
  options.within = hlod::Within::splits;
  write_ohlod(folder.path("city.ohlod"),
              hlod::build_hlod(generate("city", {{"blocks", 6}, {"facade_cells", 2}}), options), {});
  return folder.path("city.ohlod");
}

std::filesystem::path write_sheet(const Folder& folder, const std::string& name, OhlodImages images) {
  constexpr int squares = 64, texels = 256;
  TriangleMesh mesh;
  mesh.texture_origin = TextureOrigin::top_left;
  std::vector<glm::u8vec4> pixels;
  for (int y = 0; y < texels; ++y)
    for (int x = 0; x < texels; ++x) pixels.emplace_back(x, y, 40, 255);
  mesh.textures.resize(1);
  mesh.textures[0].mime_type = "image/png";
  mesh.textures[0].bytes = encode_png(pixels, texels);
  mesh.materials.resize(1);
  mesh.materials[0].texture = 0;
  for (int y = 0; y <= squares; ++y)
    for (int x = 0; x <= squares; ++x) {
      const glm::vec2 at = glm::vec2(x, y) / static_cast<float>(squares);
      mesh.positions.emplace_back(at, 0.02F * std::sin(20.0F * at.x) * std::cos(15.0F * at.y));
      mesh.texture_coordinates.push_back(glm::mix(glm::vec2(0.02F), glm::vec2(0.98F), at));
    }
  for (int y = 0; y < squares; ++y)
    for (int x = 0; x < squares; ++x) {
      const auto a = static_cast<VertexId>(y * (squares + 1) + x);
      const VertexId b = a + squares + 1;
      mesh.triangles.insert(mesh.triangles.end(), {{a, a + 1, b}, {a + 1, b + 1, b}});
    }
  mesh.triangle_materials.assign(mesh.triangles.size(), 0);
  hlod::HlodBuildOptions options;
  options.node_triangles = 256;
  write_ohlod(folder.path(name), hlod::build_hlod(mesh, options), {}, {.images = images});
  return folder.path(name);
}

nlohmann::json city_scene(const std::string& mesh) {
  const auto look = [](const nlohmann::json& eye, const nlohmann::json& target) {
    return nlohmann::json{{"eye", eye},  {"target", target}, {"up", {0, 0, 1}}, {"fov_y_deg", 60},
                          {"near", 0.2}, {"far", 1500},      {"width", 160},    {"height", 120}};
  };
  const nlohmann::json street = look({65, 181, 1.7}, {300, 180, 8});
  return {{"objects", {{{"mesh", mesh}}}},
          {"cameras", {{"default", street}, {"above", look({70, 20, 150}, {170, 185, 0})}}},
          {"paths", {{"by", {{"frames", 5}, {"keys", {street, look({95, 181, 1.7}, {250, 330, 8})}}}}}}};
}

nlohmann::json street_scene() {
  nlohmann::json scene = city_scene("");
  scene["objects"] = {{{"generator", "city"}, {"options", {{"blocks", 6}, {"facade_cells", 3}}}}};
  return scene;
}

std::filesystem::path write_street_cells(const Folder& folder, const Objects& objects) {
  Camera camera;  // as that of the scene
  camera.width = 160;
  camera.height = 120;
  camera.fov_y_deg = 60.0;
  camera.near = 0.2;
  CellTreeOptions options;
  options.cell.eyes = eye_model(View(camera));
  options.regions = {{{60.0, 176.0, 1.0}, {100.0, 186.0, 2.5}}};
  options.root_cell = 10.0;
  options.max_triangles = 1'000'000;  // no cell is divided
  CellBuild(refine_objects(objects), options).write(folder.path("city.vlod"));
  return folder.path("city.vlod");
}

std::unique_ptr<Visibility> make_portable_visibility(Occlusion occlusion) {
  if (occlusion == Occlusion::none) return std::make_unique<NoOcclusion>();
  return make_software_occlusion();
}

void settle(Session& session) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  do {
    session.update(0.01, 100.0);
    session.picture_drawn({});
    ASSERT_LT(std::chrono::steady_clock::now(), end) << "the session does not settle";
  } while (!session.settled());
}

void act(Session& session, const nlohmann::json& action) {
  const std::string from = "test";
  session.perform(JsonPlace(action, from));
  settle(session);
}

}  // namespace occlod::viewer::test
