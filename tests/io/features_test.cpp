#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "io/mesh_files.h"

namespace occlod {
namespace {

using Names = std::vector<std::string>;
using Ids = std::vector<FeatureId>;

class Features : public testing::Test {
 protected:
  // A file with four vertices and these lines.
  [[nodiscard]] TriangleMesh obj(const std::string& lines) const {
    return folder_.read("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n" + lines).mesh;
  }

  test::TestFolder folder_;
};

// A quad is two triangles. Groups are numbered by their first faces: b, which has none, has no number.
TEST_F(Features, OfObjAreGroups) {
  const TriangleMesh mesh = obj("g north wall\nf 1 2 3 4\ng b\ng c\nf 1 2 3\ng north wall\nf 1 3 4\n");
  EXPECT_EQ(mesh.feature_names, (Names{"north wall", "c"}));
  EXPECT_EQ(mesh.triangle_features, (Ids{0, 0, 1, 0}));
}

// An object without groups has its own name. Groups of one name in two objects are two features; faces before the
// first line have none.
TEST_F(Features, OfObjAreGroupsOfObjects) {
  const TriangleMesh mesh = obj("f 1 2 3\no a\nf 1 2 3\ng wall\nf 1 2 3\no b\ng wall\nf 1 2 3\ng\nf 1 2 3\n");
  EXPECT_EQ(mesh.feature_names, (Names{"", "a", "a/wall", "b/wall", "b"}));
  EXPECT_EQ(mesh.triangle_features, (Ids{0, 1, 2, 3, 4}));
}

// One feature needs no ids, and one without a name says nothing. Latin-1 becomes UTF-8.
TEST_F(Features, OfObjCostNothingWhereThereIsOne) {
  const TriangleMesh one =
      obj("o Stra\xdf"
          "e\nf 1 2 3\nf 1 3 4\n");
  EXPECT_EQ(one.feature_names, Names{"Stra\xc3\x9f"
                                     "e"});
  EXPECT_TRUE(one.triangle_features.empty());
  EXPECT_EQ(one.feature_of(1), 0U);
  for (const char* const lines : {"f 1 2 3\n", "g\nf 1 2 3\n", "f 1 2 3\no\nf 1 3 4\n"}) {
    EXPECT_TRUE(obj(lines).feature_names.empty()) << lines;
    EXPECT_TRUE(obj(lines).triangle_features.empty()) << lines;
  }
}

// The first triangle repeats a corner and is dropped, with its feature.
TEST_F(Features, StayWithTheirTriangles) {
  const TriangleMesh mesh = obj("g a\nf 1 1 2\ng b\nf 1 2 3\ng c\nf 1 3 4\n");
  EXPECT_EQ(mesh.feature_names, (Names{"a", "b", "c"}));
  EXPECT_EQ(mesh.triangle_features, (Ids{1, 2}));
  EXPECT_EQ(crease_normals(mesh, 30.0).triangle_features, mesh.triangle_features);
  EXPECT_TRUE(mesh.extra_wedges.empty());  // they make no seams
}

TEST_F(Features, ThatAreNotThereAreRefused) {
  TriangleMesh mesh = obj("g a\nf 1 2 3\ng b\nf 1 3 4\n");
  mesh.triangle_features[1] = 2;
  try {
    static_cast<void>(clean(mesh, {}, "mesh"));
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.diagnosis().place, "triangle 1");
    EXPECT_EQ(error.diagnosis().problem, "has feature 2, but there are 2, numbered from 0");
  }
}

// Integers alone: fractions are values of something.
TEST_F(Features, OfPlyAreNumbersOfFaces) {
  const auto ply = [&](const std::string& property) {
    return folder_
        .read("a.ply",
              "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
              "element face 3\nproperty list uchar int vertex_indices\nproperty " +
                  property + "\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 7\n3 0 1 2 -1\n3 0 2 3 7\n")
        .mesh;
  };
  const TriangleMesh mesh = ply("int object_id");
  EXPECT_EQ(mesh.feature_names, (Names{"object_id 7", "object_id -1"}));
  EXPECT_EQ(mesh.triangle_features, (Ids{0, 0, 1, 0}));
  for (const char* const property : {"float object_id", "int quality"})
    EXPECT_TRUE(ply(property).feature_names.empty()) << property;
}

// One triangle, 0 0 0, 1 0 0, 0 1 0, placed by four nodes: a node without a name has that of the nearest above it, and
// that of its mesh where none has one.
TEST_F(Features, OfGltfAreNodes) {
  const TriangleMesh mesh =
      folder_
          .read("a.gltf", R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 3]}],
          "nodes": [{"name": "house", "children": [1, 2]}, {"mesh": 0, "name": "door"}, {"mesh": 0, "children": [4]},
                    {"mesh": 0}, {"mesh": 0}],
          "meshes": [{"name": "brick", "primitives": [{"attributes": {"POSITION": 0}}]}],
          "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
          "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"byteLength": 36, "uri":
            "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})")
          .mesh;
  EXPECT_EQ(mesh.feature_names, (Names{"door", "house", "house", "brick"}));
  EXPECT_EQ(mesh.triangle_features, (Ids{0, 1, 2, 3}));
}

}  // namespace
}  // namespace occlod
