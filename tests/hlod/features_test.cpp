#include "hlod/store/features.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "hlod/store/hlod_data.h"
#include "occlod/build_hlod.h"
#include "occlod/node_store.h"
#include "support/meshes.h"

namespace occlod::hlod {
namespace {

using Corners = std::array<std::tuple<float, float, float>, 3>;

Corners corners_of(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  Corners corners{std::tuple(a.x, a.y, a.z), std::tuple(b.x, b.y, b.z), std::tuple(c.x, c.y, c.z)};
  std::sort(corners.begin(), corners.end());
  return corners;
}

// A bumpy square of 32 x 32 cells in 4 x 4 features of equal size, named by row and column.
TriangleMesh checkered() {
  TriangleMesh mesh = test::grid(32, 32);
  for (glm::vec3& p : mesh.positions) p.z = 0.02F * std::sin(20.0F * p.x) * std::cos(17.0F * p.y);
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      mesh.feature_names.push_back(std::to_string(row) + "," + std::to_string(column));
  for (const Triangle& t : mesh.triangles) {
    const glm::vec3 middle = (mesh.positions[t.x] + mesh.positions[t.y] + mesh.positions[t.z]) / 3.0F;
    mesh.triangle_features.push_back(static_cast<FeatureId>(4.0F * middle.y) * 4 +
                                     static_cast<FeatureId>(4.0F * middle.x));
  }
  return mesh;
}

HlodBuildOptions options() {
  HlodBuildOptions options;
  options.node_triangles = 64;
  options.threads = 2;
  return options;
}

// Calls visit(node, triangle of its mesh, feature).
template <typename Visit>
void for_each_triangle(const Hlod& hlod, const Visit& visit) {
  for (NodeId n = 0; n < hlod.node_count(); ++n) {
    const std::span<const FeatureRun> runs = hlod.features(n);
    std::size_t run = 0;
    for (std::uint32_t t = 0; t < hlod.node(n).triangles; ++t) {
      if (run + 1 < runs.size() && runs[run + 1].first_triangle == t) ++run;
      visit(n, t, runs[run].feature);
    }
  }
}

// On level 0 each triangle has the feature that it has in the input. On all levels no vertex is of two features, and
// all features are left: they are of one size, and the coarsest level has several triangles for each.
TEST(HlodFeatures, SurviveSimplification) {
  const TriangleMesh mesh = checkered();
  std::map<Corners, FeatureId> expected;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Triangle& c = mesh.triangles[t];
    expected[corners_of(mesh.positions[c.x], mesh.positions[c.y], mesh.positions[c.z])] = mesh.triangle_features[t];
  }
  const Hlod hlod = build_hlod(mesh, options());
  EXPECT_TRUE(validate(hlod).empty());
  EXPECT_TRUE(restores(hlod, mesh));
  EXPECT_TRUE(std::ranges::equal(hlod.data().features.names, mesh.feature_names));
  ASSERT_GE(hlod.level_count(), 3U);
  std::vector<std::set<FeatureId>> of_level(hlod.level_count());
  std::map<std::pair<NodeId, std::uint16_t>, FeatureId> of_vertex;
  for_each_triangle(hlod, [&](NodeId n, std::uint32_t t, FeatureId feature) {
    const NodeMesh node = hlod.mesh(n);
    of_level[hlod.node(n).level].insert(feature);
    const std::uint16_t* const c = &node.indices[3 * std::size_t{t}];
    if (hlod.node(n).level == 0) {
      EXPECT_EQ(feature, expected.at(corners_of(node.positions[c[0]], node.positions[c[1]], node.positions[c[2]])));
    }
    for (int k = 0; k < 3; ++k) EXPECT_EQ(of_vertex.try_emplace({n, c[k]}, feature).first->second, feature);
  });
  for (const std::set<FeatureId>& features : of_level) EXPECT_EQ(features.size(), 16U);
}

// The same bytes, however many threads, and in pieces.
TEST(HlodFeatures, AreTheSameInPieces) {
  const TriangleMesh mesh = checkered();
  const Hlod whole = build_hlod(mesh, options());
  HlodBuildOptions alone = options();
  alone.threads = 1;
  MeshReport report;
  const TriangleSource source = [&](TriangleSink& sink) {
    for (std::size_t begin = 0; begin < mesh.triangle_count(); begin += 300) {
      TriangleMesh piece = mesh;
      const auto part = [&](auto& all) {
        const auto first = all.begin() + static_cast<std::ptrdiff_t>(begin);
        all = {first, first + static_cast<std::ptrdiff_t>(std::min<std::size_t>(300, all.size() - begin))};
      };
      part(piece.triangles);
      part(piece.triangle_features);
      sink.add(piece);
    }
  };
  const Hlod pieces = build_hlod(source, options(), report);
  const Hlod by_one_thread = build_hlod(mesh, alone);
  for (const Hlod* const other : {&pieces, &by_one_thread}) {
    EXPECT_TRUE(std::ranges::equal(whole.data().meshes, other->data().meshes));
    EXPECT_TRUE(std::ranges::equal(whole.data().features.names, other->data().features.names));
    EXPECT_TRUE(std::ranges::equal(whole.data().features.first_run, other->data().features.first_run));
    EXPECT_TRUE(std::ranges::equal(whole.data().features.runs, other->data().features.runs,
                                   [](const FeatureRun& a, const FeatureRun& b) {
                                     return a.first_triangle == b.first_triangle && a.feature == b.feature;
                                   }));
  }
}

// One feature, used or not, makes the HLOD of a mesh without.
TEST(HlodFeatures, CostNothingWhereThereIsOne) {
  TriangleMesh mesh = checkered();
  const auto plain = [&] {
    TriangleMesh without = mesh;
    without.triangle_features.clear();
    without.feature_names.clear();
    return build_hlod(without, options());
  }();
  mesh.triangle_features.assign(mesh.triangle_count(), 3);
  const Hlod hlod = build_hlod(mesh, options());
  EXPECT_TRUE(hlod.data().features.names.empty());
  EXPECT_TRUE(hlod.features(0).empty());
  EXPECT_TRUE(std::ranges::equal(hlod.data().meshes, plain.data().meshes));
}

class HlodFeatureFile : public testing::TestWithParam<OlodCompression> {
 protected:
  HlodFeatureFile()
      : path_(std::filesystem::temp_directory_path() / ("features-" + std::to_string(getpid()) + ".ohlod")) {}
  ~HlodFeatureFile() override {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  std::filesystem::path path_;
};

TEST_P(HlodFeatureFile, HasThem) {
  const Hlod hlod = build_hlod(checkered(), options());
  write_ohlod(path_, hlod, {}, {.compression = GetParam()});
  for (const Hlod& read : {read_ohlod(path_).hlod, open_ohlod(path_, {.budget_bytes = std::size_t{1} << 20U}).hlod}) {
    EXPECT_TRUE(std::ranges::equal(read.data().features.names, hlod.data().features.names));
    for (NodeId n = 0; n < hlod.node_count(); ++n) {
      ASSERT_EQ(read.features(n).size(), hlod.features(n).size());
      for (std::size_t i = 0; i < hlod.features(n).size(); ++i) {
        EXPECT_EQ(read.features(n)[i].first_triangle, hlod.features(n)[i].first_triangle);
        EXPECT_EQ(read.features(n)[i].feature, hlod.features(n)[i].feature);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Compressions, HlodFeatureFile, testing::Values(OlodCompression::none, OlodCompression::zstd));

// Each kind of damage is found.
TEST(HlodFeatures, ThatAreDamagedAreRefused) {
  const Hlod hlod = build_hlod(checkered(), options());
  const auto problem = [&](const auto& damage) {
    HlodData data = copy_data(hlod);
    damage(data.features);
    return check_structure(view_of(data)).value_or("");
  };
  EXPECT_EQ(problem([](FeatureData&) {}), "");
  EXPECT_NE(problem([](FeatureData& f) { f.runs[0].feature = 16; }), "");
  EXPECT_NE(problem([](FeatureData& f) { f.runs[0].first_triangle = 1; }), "");
  EXPECT_NE(problem([](FeatureData& f) { f.runs[1].first_triangle = 4096; }), "");
  EXPECT_NE(problem([](FeatureData& f) { f.runs[1].first_triangle = 0; }), "");
  EXPECT_NE(problem([](FeatureData& f) { f.runs.pop_back(); }), "");
  EXPECT_NE(problem([](FeatureData& f) { f.first_run.pop_back(); }), "");
  EXPECT_NE(problem([](FeatureData& f) { f.first_run[1] = 1'000'000; }), "");
  EXPECT_NE(problem([](FeatureData& f) { f.names.clear(); }), "");
}

}  // namespace
}  // namespace occlod::hlod
