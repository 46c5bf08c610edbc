#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "occlod/scene.h"
#include "scene/loaded_scenes.h"
#include "splits/hierarchy_data.h"

namespace occlod {
namespace {

using test::scene_of;

constexpr int level = 2;
constexpr int reporting_level = 6;  // 16,386 vertices: builds of a few vertices are over before they report progress
constexpr std::size_t planet_triangles = 128;  // 8 * 4^level

SceneObject planet(int subdivisions, double seed = 1) {
  return {.source = GeneratedMesh{"rough-planet", {{"level", subdivisions}, {"seed", seed}}}};
}

SceneObject planet_that_reports() { return planet(reporting_level); }

SceneObject small_planet(double seed = 1) { return planet(level, seed); }

class LoadObjects : public test::LoadedScenes {
 protected:
  std::vector<LoadedObject> load(const SceneDescription& scene) {
    LoadOptions options = noting_options();
    options.build.base_triangles = base_triangles_;
    return load_objects(scene, folder(), options);
  }

  std::size_t base_triangles_ = 16;
};

const char* quad = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";

TEST_F(LoadObjects, SharesHierarchiesOfEqualSources) {
  const auto objects = load(scene_of({small_planet(1), small_planet(2), small_planet(1)}));
  ASSERT_EQ(objects.size(), 3U);
  EXPECT_EQ(objects[0].hierarchy, objects[2].hierarchy);
  EXPECT_NE(objects[0].hierarchy, objects[1].hierarchy);
  EXPECT_EQ(objects[0].hierarchy->input_triangle_count(), planet_triangles);
}

TEST_F(LoadObjects, KeepsPlacementSidesAndWhatCounts) {
  SceneObject object = small_planet();
  object.object_to_world[3] = {1, 2, 3, 1};
  object.two_sided = true;
  object.attributes = false;
  const auto objects = load(scene_of({object}));
  EXPECT_EQ(objects[0].object_to_world, object.object_to_world);
  EXPECT_TRUE(objects[0].two_sided);
  EXPECT_FALSE(objects[0].attributes);
}

TEST_F(LoadObjects, ReadsTheFirstMeshThatIsFound) {
  (void)write("b.off", quad);
  const auto objects = load(scene_of({{.source = MeshFile{{"a.off", "b.off", "c.off"}}}}));
  EXPECT_EQ(objects[0].hierarchy->input_triangle_count(), 2U);
  EXPECT_EQ(objects[0].source_name, (folder() / "b.off").string());
}

// Scene, object, names, every folder in the order of the search, and what to do.
TEST_F(LoadObjects, SaysWhichMeshIsMissingAndWhereItWasLookedFor) {
  setenv("OCCLOD_MESHES", "/first:/second", 1);
  SceneDescription scene = scene_of({small_planet(), {.source = MeshFile{{"a.off", "b.off"}}}});
  for (const char* file : {"", "scenes/s.json"}) {
    scene.file = file;
    try {
      (void)load(scene);
      FAIL() << "nothing was missed";
    } catch (const Error& error) {
      EXPECT_EQ(error.diagnosis().subject, *file == 0 ? "test" : file);
      EXPECT_EQ(error.diagnosis().place, "/objects/1/mesh");
      EXPECT_EQ(error.diagnosis().problem, "there is no file a.off or b.off; searched: " + folder().string() +
                                               ", /first, /second, " + (folder() / "data/occlod/meshes").string());
      EXPECT_NE(error.diagnosis().remedy.find("OCCLOD_MESHES"), std::string::npos);
    }
  }
}

TEST_F(LoadObjects, TakesHierarchiesAsTheyAre) {
  const auto planet = load(scene_of({small_planet()}))[0].hierarchy;
  write_olod(folder() / "planet.OLOD", *planet, MeshReport{});
  const std::size_t cached_before = cached().size();
  const auto objects = load(scene_of({{.source = MeshFile{{"planet.OLOD"}}}}));
  EXPECT_EQ(copy_data(*objects[0].hierarchy).stars, copy_data(*planet).stars);
  EXPECT_EQ(cached().size(), cached_before);
}

// Progress is told by the build alone: none means that nothing was built.
TEST_F(LoadObjects, BuildsOnceAndThenReadsTheCache) {
  const auto built = load(scene_of({planet_that_reports()}));
  EXPECT_GT(progress_, 0);
  EXPECT_EQ(cached().size(), 1U);
  progress_ = 0;
  const auto fetched = load(scene_of({planet_that_reports()}));
  EXPECT_EQ(progress_, 0);
  EXPECT_EQ(copy_data(*fetched[0].hierarchy).stars, copy_data(*built[0].hierarchy).stars);
  EXPECT_EQ(copy_data(*fetched[0].hierarchy).positions, copy_data(*built[0].hierarchy).positions);
  EXPECT_TRUE(notes_.empty());
}

TEST_F(LoadObjects, CachesUnderInputAndOptions) {
  (void)load(scene_of({small_planet(1)}));
  (void)load(scene_of({small_planet(2)}));  // another generator option
  EXPECT_EQ(cached().size(), 2U);
  base_triangles_ = 32;  // another build option
  (void)load(scene_of({small_planet(1)}));
  EXPECT_EQ(cached().size(), 3U);
  (void)write("m.off", quad);
  (void)load(scene_of({{.source = MeshFile{{"m.off"}}}}));
  EXPECT_EQ(cached().size(), 4U);
  (void)write("m.off", std::string(quad) + "\n");  // other bytes under the same name
  (void)load(scene_of({{.source = MeshFile{{"m.off"}}}}));
  EXPECT_EQ(cached().size(), 5U);
  (void)write("n.off", quad);  // the same bytes under another name
  (void)load(scene_of({{.source = MeshFile{{"n.off"}}}}));
  EXPECT_EQ(cached().size(), 5U);
}

TEST_F(LoadObjects, CachesUnderFilesThatAMeshNames) {
  const auto load_file = [&](const char* name) { return load(scene_of({{.source = MeshFile{{name}}}})); };
  (void)write("m.obj", "mtllib colours.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  const auto color = [&] { return load_file("m.obj")[0].hierarchy->data().materials[0].base_color.x; };
  (void)write("colours.mtl", "newmtl a\nKd 0 0 0\n");
  EXPECT_EQ(color(), 0.0F);
  EXPECT_EQ(color(), 0.0F);
  EXPECT_EQ(cached().size(), 1U);
  (void)write("colours.mtl", "newmtl a\nKd 1 0 0\n");
  EXPECT_EQ(color(), 1.0F);
  EXPECT_EQ(cached().size(), 2U);

  (void)write("m.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "buffers": [{"uri": "the%20corners", "byteLength": 36}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [9, 9, 9]}]})");
  const auto width = [&](float to) {
    const std::array<float, 9> corners = {0, 0, 0, to, 0, 0, 0, 1, 0};
    std::string bytes(sizeof(corners), '\0');
    std::memcpy(bytes.data(), corners.data(), bytes.size());
    (void)write("the corners", bytes);
    return load_file("m.gltf")[0].hierarchy->data().box.max.x;
  };
  EXPECT_EQ(width(1.0F), 1.0F);
  EXPECT_EQ(width(2.0F), 2.0F);
}

// What may stand where a cached hierarchy should be: the mesh is built again, as if there were no cache, one line tells
// which file was wrong, and the next run finds the entry whole.
class DamagedCache : public LoadObjects {
 protected:
  DamagedCache() { expected_ = copy_data(*load(scene_of({planet_}))[0].hierarchy); }

  [[nodiscard]] std::filesystem::path entry() const { return cached().at(0); }

  void overwrite(std::uintmax_t offset, const std::string& bytes) const {
    std::fstream file(entry(), std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(static_cast<std::streamoff>(offset));
    file << bytes;
  }

  void expect_built_again() {
    const std::string file = entry().string();
    notes_.clear();
    expect_built(load(scene_of({planet_})));
    ASSERT_EQ(notes_.size(), 1U);
    EXPECT_NE(notes_[0].find(file), std::string::npos) << notes_[0];
    EXPECT_NE(notes_[0].find("built again"), std::string::npos) << notes_[0];
    EXPECT_EQ(notes_[0].find("occlod build"), std::string::npos) << notes_[0];  // it has no advice that cannot help
    notes_.clear();
    expect_built(load(scene_of({planet_})));
    EXPECT_TRUE(notes_.empty()) << notes_[0];
  }

 private:
  void expect_built(const std::vector<LoadedObject>& objects) const {
    ASSERT_NO_THROW(objects.at(0).hierarchy->require_all());
    const HierarchyData data = copy_data(*objects.at(0).hierarchy);
    EXPECT_EQ(data.positions, expected_.positions);
    EXPECT_EQ(data.stars, expected_.stars);
    EXPECT_EQ(data.base_faces, expected_.base_faces);
    EXPECT_EQ(data.roots, expected_.roots);
    EXPECT_EQ(data.error_bound, expected_.error_bound);
  }

  SceneObject planet_ = planet(4);  // 2,048 triangles
  HierarchyData expected_;
};

// Opening the file looks at its table and its base mesh only: bytes of the splits are found later, or never.
TEST_F(DamagedCache, BytesAnywhere) {
  const std::uintmax_t size = std::filesystem::file_size(entry());
  ASSERT_GT(size, 20'000U);
  std::vector<std::uintmax_t> offsets = {0, 40, 5000, size - 8};
  for (std::uintmax_t offset = 100; offset + 8 < size; offset += size / 16) offsets.push_back(offset);
  for (const std::uintmax_t offset : offsets) {
    SCOPED_TRACE(offset);
    overwrite(offset, "ABCDEFGH");
    expect_built_again();
  }
}

TEST_F(DamagedCache, CutShort) {
  for (const std::uintmax_t divisor : {2U, 1000U}) {
    std::filesystem::resize_file(entry(), std::filesystem::file_size(entry()) / divisor);
    expect_built_again();
  }
  std::filesystem::resize_file(entry(), 0);
  expect_built_again();
}

TEST_F(DamagedCache, AFolder) {
  const std::filesystem::path path = entry();
  std::filesystem::remove(path);
  std::filesystem::create_directory(path);
  expect_built_again();
}

TEST_F(DamagedCache, ALinkToNowhere) {
  const std::filesystem::path path = entry();
  std::filesystem::remove(path);
  std::filesystem::create_symlink(folder() / "nowhere" / "a.olod", path);
  expect_built_again();
}

TEST_F(DamagedCache, AFileThatMayNotBeRead) {
  std::filesystem::permissions(entry(), std::filesystem::perms::none);
  if (std::ifstream(entry())) GTEST_SKIP() << "this user may read every file";
  expect_built_again();
}

// A file stands where the folder should be, so that it cannot be made, whoever runs the test.
TEST_F(LoadObjects, LoadsWithoutACacheThatCannotBeWritten) {
  (void)write("cache", "a file");
  EXPECT_EQ(load(scene_of({small_planet()}))[0].hierarchy->input_triangle_count(), planet_triangles);
  EXPECT_EQ(notes_.size(), 1U);
}

TEST_F(LoadObjects, LeavesTheCacheAloneWhenAsked) {
  use_cache_ = false;
  (void)load(scene_of({small_planet()}));
  EXPECT_TRUE(cached().empty());
}

TEST_F(LoadObjects, CanBeCancelled) {
  LoadOptions options;
  options.build.progress = [](double) { return false; };
  EXPECT_THROW((void)load_objects(scene_of({planet_that_reports()}), folder(), options), Error);
}

}  // namespace
}  // namespace occlod
