// Scenes whose world coordinates have more digits than floats have.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "occlod/build_hlod.h"
#include "occlod/item_buffer.h"
#include "occlod/mesh_file.h"
#include "occlod/picture.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"
#include "occlod/visibility.h"
#include "scene_folder.h"
#include "support/meshes.h"

namespace occlod {
namespace {

constexpr double tenth_mm = 1e-4;
const glm::dvec3 utm(691607.37, 5334760.81, 519.93);

class SceneOrigin : public test::SceneFolder {
 protected:
  SceneOrigin() {
    // Bumps, so that splits have errors.
    mesh_ = test::grid(20, 20);
    for (glm::vec3& p : mesh_.positions) p.z = 0.05F * std::sin(7.0F * p.x) * std::cos(5.0F * p.y);
    write_mesh(folder() / "near.ply", mesh_);
    for (const glm::vec3& p : mesh_.positions) far_.push_back(utm + glm::dvec3(p));
    static_cast<void>(write("far.obj", obj_of(far_)));
  }

  [[nodiscard]] std::string obj_of(const std::vector<glm::dvec3>& points) const {
    std::string text;
    for (const glm::dvec3& p : points) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    for (const Triangle& t : mesh_.triangles) text += fmt::format("f {} {} {}\n", t.x + 1, t.y + 1, t.z + 1);
    return text;
  }

  static SceneDescription scene_of(const std::vector<std::pair<std::string, glm::dvec3>>& objects) {
    SceneDescription scene;
    scene.name = "scene";
    for (const auto& [file, place] : objects) {
      SceneObject& object = scene.objects.emplace_back();
      object.source = MeshFile{{file}};
      object.object_to_world[3] = glm::dvec4(place, 1.0);
    }
    return scene;
  }

  // Every point of the mesh is a point of the scene.
  static double farthest_from(const TriangleMesh& mesh, const std::vector<glm::dvec3>& points) {
    double most = 0.0;
    for (const glm::vec3& p : mesh.positions) {
      double least = std::numeric_limits<double>::infinity();
      for (const glm::dvec3& q : points) least = std::min(least, glm::distance(mesh.origin + glm::dvec3(p), q));
      most = std::max(most, least);
    }
    return most;
  }

  TriangleMesh mesh_;            // near 0
  std::vector<glm::dvec3> far_;  // its points in far.obj
};

TEST_F(SceneOrigin, FlattenedScenesHaveOneOfTheirOwn) {
  std::vector<glm::dvec3> both = far_;
  for (const glm::dvec3& p : far_) both.push_back(p + glm::dvec3(2.0, 0.0, 0.0));
  for (const SceneDescription& scene :
       {scene_of({{"near.ply", utm}}), scene_of({{"far.obj", glm::dvec3(0.0)}}),
        scene_of({{"far.obj", glm::dvec3(0.0)}, {"near.ply", utm + glm::dvec3(2.0, 0.0, 0.0)}})}) {
    const CleanMesh flat = flatten_scene(scene, folder());
    EXPECT_NE(flat.mesh.origin, glm::dvec3(0.0));
    EXPECT_EQ(flat.mesh.triangle_count(), scene.objects.size() * mesh_.triangle_count());
    EXPECT_LT(farthest_from(flat.mesh, both), tenth_mm);
    // Streamed, they are the same.
    MeshReport report;
    const hlod::Hlod streamed = hlod::build_hlod(stream_scene(scene, folder()), {}, report);
    EXPECT_EQ(streamed.data().origin, flat.mesh.origin);
    EXPECT_TRUE(restores(streamed, flat.mesh));
    EXPECT_TRUE(restores(streamed, stream_scene(scene, folder())));
  }
}

TEST_F(SceneOrigin, OneFileKeepsItsPositionsToTheBit) {
  const TriangleMesh read = read_mesh(folder() / "far.obj").mesh;
  const TriangleMesh flat = flatten_scene(scene_of({{"far.obj", glm::dvec3(0.0)}}), folder()).mesh;
  EXPECT_EQ(flat.origin, read.origin);
  EXPECT_EQ(flat.positions, read.positions);
}

TEST_F(SceneOrigin, NearScenesHaveNone) {
  const SceneDescription scene = scene_of({{"near.ply", glm::dvec3(0.1)}, {"near.ply", glm::dvec3(1.3, 0.0, 0.0)}});
  EXPECT_EQ(flatten_scene(scene, folder()).mesh.origin, glm::dvec3(0.0));
  MeshReport report;
  EXPECT_EQ(hlod::build_hlod(stream_scene(scene, folder()), {}, report).data().origin, glm::dvec3(0.0));
}

TEST_F(SceneOrigin, TilesOfAMapWeldWhereTheyMeet) {
  std::vector<glm::dvec3> next;
  for (const glm::dvec3& p : far_) next.push_back({p.x + (far_[20].x - far_[0].x), p.y, p.z});
  for (std::size_t y = 0; y <= 20; ++y) next[21 * y] = far_[21 * y + 20];  // its first column is the last of the other
  static_cast<void>(write("next.obj", obj_of(next)));
  const CleanMesh flat =
      flatten_scene(scene_of({{"far.obj", glm::dvec3(0.0)}, {"next.obj", glm::dvec3(0.0)}}), folder());
  EXPECT_EQ(flat.report.vertices_welded, 21U);
  EXPECT_EQ(flat.report.components, 1U);
}

// Everything that refinement sees of a mesh on a map is what it sees of the same mesh at 0.
TEST_F(SceneOrigin, RefinementAndPicturesAreThoseOfTheMeshNearby) {
  LoadOptions options;
  options.use_cache = false;
  const auto picture = [&](const SceneDescription& scene, const glm::dvec3& at) {
    const std::vector<LoadedObject> loaded = load_objects(scene, folder(), options);
    const std::vector<RefineObject> objects = {{loaded[0].hierarchy.get(), loaded[0].object_to_world}};
    Camera camera;
    camera.eye = at + glm::dvec3(0.4, 0.3, 1.2);
    camera.target = at + glm::dvec3(0.5, 0.5, 0.0);
    camera.near = 0.01;
    camera.far = 10.0;
    camera.width = camera.height = 128;
    const View view(camera);
    Refiner refiner(objects);
    NoOcclusion none;
    RefineOptions refine;
    refine.budget = 300;
    const Refinement& refinement = refiner.refine(view, refine, none);
    ItemBuffer items;
    draw_items(items,
               std::vector<DrawObject>{
                   {loaded[0].hierarchy->positions(), {}, refinement.objects[0].triangles, loaded[0].object_to_world}},
               view);
    return std::pair(refinement.objects[0].splits.size(), items.items);
  };
  const auto near = picture(scene_of({{"near.ply", glm::dvec3(0.0)}}), glm::dvec3(0.0));
  const auto placed = picture(scene_of({{"near.ply", utm}}), utm);
  const auto on_map = picture(scene_of({{"far.obj", glm::dvec3(0.0)}}), utm);
  ASSERT_GT(std::ranges::count_if(near.second, [](std::uint32_t item) { return item != no_item; }), 5000);
  EXPECT_EQ(placed, near);
  EXPECT_EQ(on_map.first, near.first);
  std::size_t differ = 0;  // positions were rounded elsewhere: pixels on edges may be another triangle's
  for (std::size_t i = 0; i < near.second.size(); ++i)
    differ += (near.second[i] == no_item) != (on_map.second[i] == no_item);
  EXPECT_LT(differ, 10U);
}

TEST_F(SceneOrigin, HlodsAreLoadedAtTheirCoordinates) {
  LoadOptions options;
  options.use_cache = false;
  const glm::dvec3 shift(10.0, 0.0, 0.0);
  for (const SceneDescription& scene : {scene_of({{"far.obj", shift}}), scene_of({{"near.ply", utm + shift}})}) {
    const std::vector<LoadedHlod> loaded = load_hlods(scene, folder(), options);
    const Box& box = loaded[0].hlod->data().box;
    EXPECT_LT(glm::distance(glm::dvec3(loaded[0].object_to_world * glm::dvec4(box.min, 1.0)),
                            shift + utm + glm::dvec3(bounding_box(mesh_.positions).min)),
              tenth_mm);
  }
}

TEST_F(SceneOrigin, JoinedMeshesKeepTheirDigits) {
  const TriangleMesh far = read_mesh(folder() / "far.obj").mesh;
  const glm::dmat4 place = positions_to_world(glm::dmat4(1.0), far.origin);
  const std::vector<PlacedMesh> one = {{&far, place, "far.obj"}};
  EXPECT_EQ(join_meshes(one, folder(), "joined").positions, far.positions);
  const std::vector<PlacedMesh> two = {{&far, place, "far.obj"}, {&mesh_, positions_to_world(place, -far.origin), ""}};
  const TriangleMesh joined = join_meshes(two, folder(), "joined");
  EXPECT_EQ(joined.origin, glm::dvec3(0.0));  // one of them is at 0: the box is large, and floats fit it as well
}

}  // namespace
}  // namespace occlod
