#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "occlod/base.h"
#include "occlod/hlod.h"
#include "occlod/node_store.h"
#include "occlod/scene.h"
#include "scene/loaded_scenes.h"

namespace occlod {
namespace {

using test::scene_of;

constexpr std::size_t planet_triangles = 8 * 64;  // 8 * 4^level

SceneObject planet(double x, double seed = 1) {
  SceneObject object{.source = GeneratedMesh{"rough-planet", {{"level", 3}, {"seed", seed}}}};
  object.object_to_world[3] = {x, 0, 0, 1};
  return object;
}

class LoadHlods : public test::LoadedScenes {
 protected:
  std::vector<LoadedHlod> load(const SceneDescription& scene) {
    LoadOptions options = noting_options();
    options.build_hlod.node_triangles = node_triangles_;
    return load_hlods(scene, folder(), options);
  }

  std::uint32_t node_triangles_ = 100;
};

TEST_F(LoadHlods, FlattensAllMeshes) {
  const SceneDescription scene = scene_of({planet(0), planet(5), planet(10, 2)});
  const auto hlods = load(scene);
  ASSERT_EQ(hlods.size(), 1U);
  EXPECT_EQ(hlods[0].object_to_world, glm::dmat4(1.0));
  EXPECT_EQ(hlods[0].source_name, "test");
  EXPECT_FALSE(hlods[0].two_sided);
  EXPECT_EQ(hlods[0].hlod->data().input_triangle_count, 3 * planet_triangles);
  EXPECT_TRUE(restores(*hlods[0].hlod, flatten_scene(scene, folder()).mesh));
}

TEST_F(LoadHlods, FlatteningKeepsTheTexturesOfItsObjects) {
  std::filesystem::create_directories(folder() / "props");
  std::ofstream(folder() / "props" / "box.mtl") << "newmtl wood\nKd 1 0.5 0.25\nmap_Kd wood.png\nnewmtl plain\n";
  std::ofstream(folder() / "props" / "box.obj")
      << "mtllib box.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0.25 0.5\nvt 1 0\nvt 0 1\n"
         "usemtl wood\nf 1/1 2/2 3/3\nusemtl plain\nf 2/2 4/1 3/3\n";
  SceneObject first{.source = MeshFile{{"props/box.obj"}}}, second = first;
  second.object_to_world[3] = {5, 0, 0, 1};
  const TriangleMesh mesh = flatten_scene(scene_of({planet(-9), first, second}), folder()).mesh;
  ASSERT_EQ(mesh.textures.size(), 1U) << "objects of one mesh share its textures";
  EXPECT_EQ(mesh.textures[0].file, "props/wood.png") << "relative to the scene";
  ASSERT_EQ(mesh.materials.size(), 3U) << "and a plain one";
  ASSERT_EQ(mesh.triangle_count(), planet_triangles + 4);
  std::vector<std::string> names;
  for (std::size_t t = planet_triangles; t < mesh.triangle_count(); ++t)
    names.push_back(mesh.materials[mesh.material_of(t)].name);
  EXPECT_EQ(names, (std::vector<std::string>{"wood", "plain", "wood", "plain"}));
  const Triangle corners = mesh.wedge_triangles()[planet_triangles];
  EXPECT_EQ(mesh.texture_coordinates[corners.x], glm::vec2(0.25F, 0.5F));
  EXPECT_EQ(mesh.texture_coordinates[mesh.wedge_triangles()[0].x], glm::vec2(0.0F)) << "of the planet";
  EXPECT_EQ(mesh.materials[mesh.material_of(0)].name, "");
  const Material& wood = mesh.materials[mesh.material_of(planet_triangles)];
  EXPECT_EQ(wood.texture, 0);
}

TEST_F(LoadHlods, FlatteningPlainObjectsSaysNothingOfMaterials) {
  const TriangleMesh mesh = flatten_scene(scene_of({planet(0), planet(5)}), folder()).mesh;
  EXPECT_TRUE(mesh.materials.empty());
  EXPECT_TRUE(mesh.triangle_materials.empty());
  EXPECT_TRUE(mesh.texture_coordinates.empty());
}

TEST_F(LoadHlods, IsTwoSidedWhereAnyMeshIs) {
  SceneDescription scene = scene_of({planet(0), planet(5)});
  scene.objects[1].two_sided = true;
  EXPECT_TRUE(load(scene)[0].two_sided);
}

TEST_F(LoadHlods, PlacesFilesAsTheSceneDoes) {
  write_ohlod(folder() / "planet.OHLOD", *load(scene_of({planet(0)}))[0].hlod, MeshReport{});
  SceneObject file{.source = MeshFile{{"planet.OHLOD"}}};
  file.object_to_world[3] = {7, 8, 9, 1};
  file.two_sided = true;
  const auto hlods = load(scene_of({file, planet(20), {.source = MeshFile{{"planet.OHLOD"}}}}));
  ASSERT_EQ(hlods.size(), 3U);  // the mesh first
  EXPECT_EQ(hlods[0].hlod->data().input_triangle_count, planet_triangles);
  EXPECT_EQ(hlods[1].object_to_world, file.object_to_world);
  EXPECT_TRUE(hlods[1].two_sided);
  EXPECT_FALSE(hlods[2].two_sided);
  EXPECT_EQ(hlods[1].hlod, hlods[2].hlod);
  EXPECT_EQ(hlods[1].source_name, (folder() / "planet.OHLOD").string());
}

TEST_F(LoadHlods, BuildsOnceAndThenReadsTheCache) {
  const SceneDescription scene = scene_of({planet(0), planet(5)});
  const auto built = load(scene);
  EXPECT_GT(progress_, 0);
  EXPECT_EQ(cached().size(), 1U);
  progress_ = 0;
  const auto fetched = load(scene);
  EXPECT_EQ(progress_, 0);
  EXPECT_EQ(fetched[0].hlod->node_count(), built[0].hlod->node_count());
  EXPECT_TRUE(restores(*fetched[0].hlod, flatten_scene(scene, folder()).mesh));
  EXPECT_TRUE(notes_.empty());
  use_cache_ = false;
  (void)load(scene);
  EXPECT_GT(progress_, 0);
}

// What is cached is what was flattened: other placements, meshes, bytes of files and options are other entries, names
// of scenes are not.
TEST_F(LoadHlods, CachesUnderInputPlacesAndOptions) {
  const char* quad = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
  (void)write("m.off", quad);
  const SceneObject file{.source = MeshFile{{"m.off"}}};
  std::size_t entries = 0;
  const auto expect_new = [&](const SceneDescription& scene) {
    (void)load(scene);
    EXPECT_EQ(cached().size(), ++entries);
    (void)load(scene);
    EXPECT_EQ(cached().size(), entries);
  };
  expect_new(scene_of({planet(0), file}));
  expect_new(scene_of({planet(1), file}));
  expect_new(scene_of({planet(0, 2), file}));
  expect_new(scene_of({file, planet(0)}));
  (void)write("m.off", std::string(quad) + "\n");
  expect_new(scene_of({planet(0), file}));
  node_triangles_ = 50;
  expect_new(scene_of({planet(0), file}));
  SceneDescription renamed = scene_of({planet(0), file});
  renamed.name = "other";
  (void)load(renamed);
  EXPECT_EQ(cached().size(), entries);
}

TEST_F(LoadHlods, BuildsAgainWhatIsDamaged) {
  const SceneDescription scene = scene_of({planet(0)});
  const std::size_t nodes = load(scene)[0].hlod->node_count();
  std::filesystem::resize_file(cached().at(0), 1000);
  EXPECT_EQ(load(scene)[0].hlod->node_count(), nodes);
  ASSERT_EQ(notes_.size(), 1U);
  EXPECT_NE(notes_[0].find("a cached HLOD is built again: " + cached().at(0).string()), std::string::npos) << notes_[0];
  (void)load(scene);
  EXPECT_EQ(notes_.size(), 1U);
}

// A file is checked as a whole before anything is drawn.
TEST_F(LoadHlods, RefusesDamagedFiles) {
  write_ohlod(folder() / "p.ohlod", *load(scene_of({planet(0)}))[0].hlod, MeshReport{});
  const SceneDescription scene = scene_of({{.source = MeshFile{{"p.ohlod"}}}});
  std::fstream file(folder() / "p.ohlod", std::ios::binary | std::ios::in | std::ios::out);
  const auto size = static_cast<std::streamoff>(std::filesystem::file_size(folder() / "p.ohlod"));
  for (std::streamoff at = size / 2; at < size / 2 + 64; ++at) file.seekp(at).put('\x55');
  file.close();
  EXPECT_THROW((void)load(scene), Error);
}

TEST_F(LoadHlods, AreNoMeshes) {
  write_ohlod(folder() / "p.ohlod", *load(scene_of({planet(0)}))[0].hlod, MeshReport{});
  const SceneDescription scene = scene_of({{.source = MeshFile{{"p.ohlod"}}}});
  try {
    (void)load_objects(scene, folder(), {.use_cache = false});
    FAIL() << "refined an HLOD";
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnosis().subject, (folder() / "p.ohlod").string());
    EXPECT_NE(error.diagnosis().remedy.find("occlod hlod render"), std::string::npos);
  }
  EXPECT_THROW((void)flatten_scene(scene, folder()), Error);
}

}  // namespace
}  // namespace occlod
