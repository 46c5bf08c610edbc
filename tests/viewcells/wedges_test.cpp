// Cells of meshes with seams and materials: what is drawn has the wedges that its faces have in the hierarchy.
#include <gtest/gtest.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <string>
#include <tuple>

#include "cells/packed_geometry.h"
#include "cells/vlod_format.h"
#include "occlod/base.h"
#include "occlod/build_cells.h"
#include "occlod/build_hierarchy.h"
#include "occlod/cell_walker.h"
#include "packed_files.h"
#include "small_cells.h"
#include "support/wedge_meshes.h"

namespace occlod {
namespace {

using test::FileOf;

// A cylinder with a seam, a cube of six charts with hard edges, a sheet of three materials in bands with a mirrored
// copy, seen from both sides; and a ball without any of it.
class Scene {
 public:
  Scene() {
    TriangleMesh cylinder = test::cylinder_with_seam(48, 24);
    cylinder.materials = {{"paint", {0.5F, 0.25F, 1.0F, 1.0F}, 0}};
    cylinder.textures = {{"paint.png", "", {}, TextureWrap::clamp, TextureWrap::mirror}};
    cylinder_ = build_hierarchy(cylinder);
    cube_ = build_hierarchy(test::cube_of_charts(10));
    TriangleMesh sheet = test::grid_of_charts(
        20, [](int i, int) { return i / 7; }, [](int, int j) { return j / 8; });
    for (glm::vec3& p : sheet.positions) p.z = 0.05F * std::sin(9.0F * p.x) * std::cos(7.0F * p.y);
    sheet.materials = {{"wood", glm::vec4(1.0F)}, {"stone", glm::vec4(0.5F), 1}, {"", glm::vec4(1.0F), 0}};
    sheet.textures = {{"", "image/png", {1, 2, 3}}, {"stone.jpg", "", {}}};
    sheet.texture_origin = TextureOrigin::top_left;
    sheet_ = build_hierarchy(sheet);
    ball_ = build_hierarchy(test::noisy_sphere(3, 1));
    const auto at = [](double x, double y, double z, const glm::dvec3& scale) {
      return glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(x, y, z)), scale);
    };
    objects_ = {{{.hierarchy = &cylinder_, .object_to_world = at(0.9, -0.2, -0.1, glm::dvec3(-0.1, 0.1, 0.1))},
                 {.hierarchy = &cube_, .object_to_world = at(0.9, 0.3, 0.0, glm::dvec3(0.1))},
                 {.hierarchy = &sheet_, .object_to_world = at(0.2, 0.7, -0.3, glm::dvec3(0.5)), .two_sided = true},
                 {.hierarchy = &sheet_, .object_to_world = at(0.2, -0.9, -0.3, glm::dvec3(-0.4, 0.4, 0.4))},
                 {.hierarchy = &ball_, .object_to_world = at(-0.3, 0.0, 0.0, glm::dvec3(0.2))}}};
  }
  [[nodiscard]] std::span<const RefineObject> objects() const { return objects_; }
  [[nodiscard]] static CellTreeOptions options() {
    CellTreeOptions options = test::SmallCells::options();
    options.regions.resize(1);
    options.root_cell = 0.25;
    options.max_triangles = 100;
    options.cell.tolerance_px = 0.25;
    return options;
  }

 private:
  Hierarchy cylinder_, cube_, sheet_, ball_;
  std::array<RefineObject, 5> objects_;
};

bool before(const Triangle& a, const Triangle& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

std::vector<Triangle> sorted(std::span<const Triangle> triangles) {
  std::vector<Triangle> result(triangles.begin(), triangles.end());
  std::ranges::sort(result, before);
  return result;
}

// What triangles look like at their corners, as bits.
using Look = std::vector<std::uint32_t>;
struct Wedges {
  std::span<const glm::vec3> positions, normals;
  std::span<const glm::u8vec4> colors;
  std::span<const glm::vec2> coordinates;
  std::span<const MaterialId> materials;
};
std::vector<Look> looks(std::span<const Triangle> triangles, const Wedges& wedges) {
  std::vector<Look> result;
  for (const Triangle& t : triangles) {
    Look& look = result.emplace_back();
    const auto add = [&](const auto& values, std::uint32_t w) {
      if (values.empty()) return;
      std::uint32_t bits[3] = {};
      std::memcpy(bits, &values[w], sizeof(values[w]));
      look.insert(look.end(), std::begin(bits), std::end(bits));
    };
    for (int k = 0; k < 3; ++k) {
      add(wedges.positions, t[k]);
      add(wedges.normals, t[k]);
      add(wedges.colors, t[k]);
      add(wedges.coordinates, t[k]);
      add(wedges.materials, t[k]);
    }
  }
  std::ranges::sort(result);
  return result;
}
Wedges wedges_of(const Hierarchy& hierarchy) {
  const HierarchyView& data = hierarchy.data();
  return {data.positions, data.normals, data.colors, data.texture_coordinates, data.wedge_materials};
}
Wedges wedges_of(const CellObjectMesh& mesh) {
  return {mesh.positions, mesh.normals, mesh.colors, mesh.texture_coordinates, mesh.materials};
}
Wedges wedges_of(const WalkedObject& object) {
  return {object.positions, object.normals, object.colors, object.texture_coordinates, object.wedge_materials};
}

void expect_same_surface(const SurfaceMaterials& found, const Hierarchy& hierarchy) {
  const HierarchyView& data = hierarchy.data();
  EXPECT_TRUE(std::ranges::equal(found.materials, data.materials));
  EXPECT_TRUE(std::ranges::equal(found.textures, data.textures));
  EXPECT_EQ(found.texture_origin, data.texture_origin);
}

class CellWedges : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    std::string pattern = (std::filesystem::temp_directory_path() / "occlod-cell-wedges-XXXXXX").string();
    folder = mkdtemp(pattern.data());
    scene = std::make_unique<Scene>();
    CellBuild(scene->objects(), Scene::options()).write(folder / "cells.vlod", 1);
    cells = open_vlod(folder / "cells.vlod", scene->objects());
    pack_cells(*cells, scene->objects(), folder / "packed.vlod");
    vlod::pack_cells(*cells, scene->objects(), folder / "plain.vlod", {}, 0);
    packed = open_vlod(folder / "packed.vlod");
    plain = test::bytes_of_file(folder / "plain.vlod");
  }
  static void TearDownTestSuite() {
    cells.reset();
    packed.reset();
    std::filesystem::remove_all(folder);
    scene.reset();
  }

  static inline std::filesystem::path folder;
  static inline std::unique_ptr<Scene> scene;
  static inline std::shared_ptr<const VlodFile> cells, packed;
  static inline std::string plain;
};

// Those that wedge_triangles_of() gives for the same splits, of which cells leave out what is hidden.
TEST_F(CellWedges, AreThoseOfTheFacesOfTheCut) {
  std::array<std::size_t, 5> extra{};
  for (CellId n = 0; n < cells->tree().nodes().size(); ++n) {
    if (!cells->tree().is_leaf(n)) continue;
    const std::vector<CellObjectCut> cuts = read_cell(*cells, scene->objects(), n);
    for (std::size_t i = 0; i < cuts.size(); ++i) {
      const Hierarchy& hierarchy = *scene->objects()[i].hierarchy;
      FixedCut cut;
      cut.applied.resize(hierarchy.split_count());
      for (const SplitId s : cuts[i].applied) cut.applied[s] = true;
      const std::vector<Triangle> active = sorted(wedge_triangles_of(hierarchy, cut)),
                                  drawn = sorted(cuts[i].triangles);
      EXPECT_TRUE(std::ranges::includes(active, drawn, before)) << "cell " << n << ", object " << i;
      for (const Triangle& t : drawn)
        for (int k = 0; k < 3; ++k) extra[i] += t[k] >= hierarchy.vertex_count() ? 1U : 0U;
    }
  }
  for (std::size_t i = 0; i < 4; ++i) EXPECT_GT(extra[i], 20U) << "or nothing is tested about object " << i;
}

// The builder gives what its file has, however it finds what is hidden.
TEST_F(CellWedges, AreGivenByBuilders) {
  for (const CellOcclusion occlusion : {CellOcclusion::none, CellOcclusion::sampled}) {
    CellOptions options = Scene::options().cell;
    options.occlusion = occlusion;
    options.sampled_eyes = 2;
    CellBuilder builder(scene->objects(), nullptr, options);
    const CellCut& built = builder.build({{0.3, -0.1, -0.1}, {0.4, 0.0, 0.0}});
    for (std::size_t i = 0; i < built.objects.size(); ++i) {
      const Hierarchy& hierarchy = *scene->objects()[i].hierarchy;
      FixedCut cut;
      cut.applied.resize(hierarchy.split_count());
      for (const SplitId s : built.objects[i].applied) cut.applied[s] = true;
      const std::vector<Triangle> drawn = sorted(built.objects[i].triangles);
      EXPECT_TRUE(std::ranges::includes(sorted(wedge_triangles_of(hierarchy, cut)), drawn, before));
      EXPECT_GT(drawn.size(), 10U);
    }
  }
}

// Corner by corner, bit by bit.
TEST_F(CellWedges, AreInPackedFiles) {
  const FileOf in_memory(plain);
  const auto without_codec = open_vlod(in_memory.path());
  EXPECT_EQ(cells->version(), 1U);
  EXPECT_EQ(packed->version(), 3U);
  for (CellId n = 0; n < cells->tree().nodes().size(); ++n) {
    if (!cells->tree().is_leaf(n)) continue;
    const std::vector<CellObjectCut> expected = read_cell(*cells, scene->objects(), n);
    const std::vector<CellObjectMesh> found = read_cell(*packed, n), again = read_cell(*without_codec, n);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const std::vector<Look> what = looks(expected[i].triangles, wedges_of(*scene->objects()[i].hierarchy));
      EXPECT_EQ(looks(found[i].triangles, wedges_of(found[i])), what) << "cell " << n << ", object " << i;
      EXPECT_EQ(looks(again[i].triangles, wedges_of(again[i])), what) << "cell " << n << ", object " << i;
      std::set<std::uint32_t> used;
      for (const Triangle& t : found[i].triangles) used.insert({t.x, t.y, t.z});
      EXPECT_EQ(used.size(), found[i].positions.size()) << "no wedge is there in vain";
    }
  }
  for (std::uint32_t i = 0; i < 5; ++i) expect_same_surface(packed->materials(i), *scene->objects()[i].hierarchy);
  EXPECT_TRUE(cells->materials(0).materials.empty());
}

TEST_F(CellWedges, AreWalkedThrough) {
  WalkOptions options;
  options.loaders = 0;
  CellWalker expected(cells, scene->objects(), options), found(packed, options);
  CellLoader expected_loader(expected), found_loader(found);
  std::size_t crossed = 0;
  for (int i = 0; i <= 40; ++i) {
    const glm::dvec3 eye(0.12 + 0.01 * i, -0.45 + 0.02 * i, 0.2 * std::sin(0.2 * i));
    const WalkedFrame &a = expected.step(eye, 1.0 / 60.0), &b = found.step(eye, 1.0 / 60.0);
    ASSERT_EQ(b.shown, a.shown);
    crossed += a.crossed ? 1U : 0U;
    for (std::uint32_t k = 0; k < a.objects.size(); ++k) {
      EXPECT_EQ(looks(b.objects[k].triangles, wedges_of(b.objects[k])),
                looks(a.objects[k].triangles, wedges_of(a.objects[k])));
      expect_same_surface(a.objects[k].surface, *scene->objects()[k].hierarchy);
      expect_same_surface(b.objects[k].surface, *scene->objects()[k].hierarchy);
    }
    if (cells->tree().is_leaf(a.shown)) {
      const std::vector<CellObjectCut> cuts = read_cell(*cells, scene->objects(), a.shown);
      for (std::size_t k = 0; k < cuts.size(); ++k)
        EXPECT_EQ(sorted(a.objects[k].triangles), sorted(cuts[k].triangles));
    }
    while (expected_loader.begin()) expected_loader.finish();
    while (found_loader.begin()) found_loader.finish();
  }
  EXPECT_GT(crossed, 2U);
}

// A hierarchy that differs in nothing else is another: cells of it would draw other corners.
TEST_F(CellWedges, ArePartOfTheScene) {
  const std::vector<RefineObject> good(scene->objects().begin(), scene->objects().end());
  const HierarchyView& sheet = good[2].hierarchy->data();
  // The cells, for this instead of the sheet.
  const auto is_refused = [&](const HierarchyView& view) {
    const Hierarchy changed(view, nullptr);
    std::vector<RefineObject> objects = good;
    objects[2].hierarchy = &changed;
    try {
      static_cast<void>(open_vlod(folder / "cells.vlod", objects));
      return false;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("object 2: has changed since its cells were built"), std::string::npos)
          << error.what();
      return true;
    }
  };
  EXPECT_FALSE(is_refused(sheet));
  const auto is_refused_with = [&]<typename Value>(std::span<const Value> HierarchyView::*array, const auto& change) {
    std::vector<Value> values((sheet.*array).begin(), (sheet.*array).end());
    EXPECT_FALSE(values.empty());
    change(values[values.size() / 2]);  // in a copy
    HierarchyView view = sheet;
    view.*array = values;
    return is_refused(view);
  };
  EXPECT_TRUE(is_refused_with(&HierarchyView::texture_coordinates, [](glm::vec2& uv) { uv.y += 0.25F; }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::extra_wedges, [](VertexId& v) { v ^= 1U; }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::wedge_materials, [](MaterialId& m) { m ^= 1U; }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::corners, [](std::uint32_t& c) { c ^= 1U; }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::corner_starts, [](std::uint32_t& c) { c ^= 1U; }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::base_corners, [](Triangle& t) { std::swap(t.x, t.y); }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::attribute_errors, [](std::uint16_t& e) { e ^= 1U; }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::materials, [](Material& m) { m.name += "s"; }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::materials, [](Material& m) { m.base_color.a = 0.75F; }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::materials, [](Material& m) { m.texture ^= 1U; }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::textures, [](Texture& t) { t.file += "2"; }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::textures, [](Texture& t) { t.mime_type += "2"; }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::textures, [](Texture& t) { t.bytes.push_back(7); }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::textures, [](Texture& t) { t.wrap_s = TextureWrap::mirror; }));
  EXPECT_TRUE(is_refused_with(&HierarchyView::textures, [](Texture& t) { t.wrap_t = TextureWrap::clamp; }));
  HierarchyView view = sheet;
  view.texture_origin = TextureOrigin::bottom_left;
  EXPECT_TRUE(is_refused(view));
  view = sheet;
  view.materials = {};
  EXPECT_TRUE(is_refused(view));
  // The same from a file.
  write_olod(folder / "sheet.olod", *good[2].hierarchy, {});
  const Hierarchy read = read_olod(folder / "sheet.olod").hierarchy;
  EXPECT_FALSE(is_refused(read.data()));
}

// As files have always had it: of seven arrays, each after its length, and of the bound of the error.
TEST_F(CellWedges, DoNotChangeTheHashOfMeshesWithoutThem) {
  const HierarchyView& ball = scene->objects()[4].hierarchy->data();
  std::string bytes;
  const auto add = [&](const auto& values) {
    const std::uint64_t count = values.size();
    bytes.append(reinterpret_cast<const char*>(&count), sizeof(count));
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  };
  add(ball.positions);
  add(ball.normals);
  add(ball.colors);
  add(ball.nodes);
  add(ball.stars);
  add(ball.roots);
  add(ball.base_faces);
  add(std::span(&ball.error_bound, 1));
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  EXPECT_EQ(cells->objects()[4].hierarchy, (std::array<std::uint64_t, 2>{hash.low64, hash.high64}));
}

// Files of meshes without textures, materials and seams are of version 2 and have no section that this has not.
TEST_F(CellWedges, CostNothingWhereThereAreNone) {
  const test::SmallCells small;
  const auto objects = small.objects();
  CellBuild(objects, test::SmallCells::options()).write(folder / "small.vlod", 1);
  const auto file = open_vlod(folder / "small.vlod", objects);
  pack_cells(*file, objects, folder / "small_packed.vlod");
  EXPECT_EQ(open_vlod(folder / "small_packed.vlod")->version(), 2U);
  std::string names;
  for (const sections::Section& s : test::sections_of(test::bytes_of_file(folder / "small_packed.vlod")))
    names += std::string(s.name.data(), 4) + " ";
  EXPECT_EQ(names, "OPTS REGN OBJS CELL MESH BPOS BNOR BCOL BFAC FRAM PIEC PERM DATA GEOM ");
}

TEST_F(CellWedges, LiesAboutThemAreFound) {
  const auto refusal_of = [&]<typename T>(std::string_view name, T, const auto& lie) {
    const FileOf file(test::with_lie<T>(plain, name, [&](std::span<T> rows) { lie(rows); }));
    try {
      static_cast<void>(open_vlod(file.path()));
      return std::string();
    } catch (const Error& error) {
      return std::string(error.what());
    }
  };
  const auto contains = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  using Corners = std::span<Triangle>;
  EXPECT_EQ(refusal_of(vlod::base_corners_name, Triangle{}, [](Corners) {}), "");
  EXPECT_TRUE(contains(refusal_of(vlod::base_corners_name, Triangle{}, [](Corners c) { c[0].y = 99; }), "BCOR"));
  using Counts = std::span<std::uint32_t>;
  EXPECT_TRUE(contains(refusal_of(vlod::base_wedges_name, std::uint32_t{}, [](Counts c) { ++c[0]; }), "elements, not"));
  EXPECT_TRUE(
      contains(refusal_of(vlod::base_wedges_name, std::uint32_t{}, [](Counts c) { c[0] = c[1] = ~0U; }), "BWED"));
  using Ids = std::span<MaterialId>;
  EXPECT_TRUE(contains(refusal_of(vlod::base_materials_name, MaterialId{}, [](Ids m) { m[3] = 3; }), "BMAT"));
  using Looks = std::span<vlod::LookRow>;
  EXPECT_TRUE(contains(refusal_of(vlod::looks_name, vlod::LookRow{}, [](Looks r) { r[1].materials = ~0U; }), "LOOK"));
  EXPECT_TRUE(contains(refusal_of(vlod::looks_name, vlod::LookRow{}, [](Looks r) { r[0].textures = 0; }), "LOOK"));
  EXPECT_TRUE(
      contains(refusal_of(vlod::looks_name, vlod::LookRow{}, [](Looks r) { r[0].texture_origin = 2; }), "LOOK"));
  // In frames: each byte changed in turn gives another mesh, or an error, never more.
  std::mt19937 random(3);
  std::size_t refused = 0, taken = 0;
  for (int i = 0; i < 120; ++i) {
    const FileOf file(test::with_lie<std::byte>(plain, vlod::geometry_name, [&](std::span<std::byte> bytes) {
      bytes[random() % bytes.size()] = std::byte(random() % 256);
    }));
    const auto opened = open_vlod(file.path());
    bool is_bad = false;
    for (CellId n = 0; n < opened->tree().nodes().size() && !is_bad; ++n) try {
        static_cast<void>(read_cell(*opened, n));
      } catch (const Error&) {
        is_bad = true;
      }
    ++(is_bad ? refused : taken);
  }
  EXPECT_GT(refused, 10U);
  EXPECT_GT(taken, 10U) << "other texture coordinates are as good";
}

}  // namespace
}  // namespace occlod
