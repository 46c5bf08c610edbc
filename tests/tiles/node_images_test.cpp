// Images of nodes in .ohlod files: what they show, how they are paged, and what becomes of damaged ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/glm.hpp>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "hlod/store/hlod_data.h"
#include "hlod/store/ohlod.h"
#include "hlod/store/remote_ohlod.h"
#include "hlod/tiles/tile_tree.h"
#include "mesh/image_codec.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"
#include "occlod/node_store.h"
#include "occlod/tiles.h"
#include "support/error_of.h"
#include "tile_support.h"

namespace occlod {
namespace {

using hlod::NodeId;
using occlod::test::error_of;
using tiles::test::Folder;

constexpr int side = 256;

// A sheet of hills that shows an image whose colour is a function of the place: red grows along x, green along y.
TriangleMesh hills() {
  TriangleMesh mesh = tiles::test::wavy_sheet(64, 3.0F);
  mesh.texture_origin = TextureOrigin::top_left;
  mesh.materials.resize(2);
  mesh.materials[1].texture = 0;
  std::vector<glm::u8vec4> pixels;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) pixels.emplace_back(x, y, 40, 255);
  mesh.textures.resize(1);
  mesh.textures[0].mime_type = "image/png";
  mesh.textures[0].bytes = encode_png(pixels, side);
  for (glm::vec2& at : mesh.texture_coordinates) at = glm::mix(glm::vec2(0.02F), glm::vec2(0.98F), at);
  mesh.triangle_materials.assign(mesh.triangles.size(), 1);
  return mesh;
}

const hlod::Hlod& built() {
  static const hlod::Hlod hlod = [] {
    hlod::HlodBuildOptions options;
    options.node_triangles = 256;
    return build_hlod(hills(), options);
  }();
  return hlod;
}

std::vector<char> bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class NodeImages : public ::testing::TestWithParam<OlodCompression> {
 protected:
  NodeImages() { write_ohlod(file_, built(), {}, {.compression = GetParam(), .images = OhlodImages::nodes}); }

  // Where the image of a node begins in the file.
  [[nodiscard]] std::uint64_t place_of(NodeId n) const {
    sections::SectionReader reader(file_, ohlod::file_kind, true);
    return reader.offset_of(ohlod::images_name) + reader.read<hlod::NodeImage>(ohlod::node_images_name)[n].place;
  }
  void damage(NodeId n) const {
    std::fstream stream(file_, std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp(static_cast<std::streamoff>(place_of(n)));
    stream << "damaged";
  }

  Folder folder_;
  std::filesystem::path file_ = folder_ / "hills.ohlod";
};

INSTANTIATE_TEST_SUITE_P(Of, NodeImages, ::testing::Values(OlodCompression::none, OlodCompression::zstd),
                         [](const auto& of) { return of.param == OlodCompression::none ? "plain" : "packed"; });

// At its corner a vertex shows the colour of its place: within two values on level 0, where texels are copied, and
// within a texel's width of colours elsewhere, whose means are of what lies within the chart alone.
TEST_P(NodeImages, ShowTheInput) {
  const OhlodFile file = read_ohlod(file_);
  EXPECT_EQ(file.version, ohlod_version);
  ASSERT_EQ(file.hlod.data().node_images.size(), built().node_count());
  EXPECT_TRUE(std::ranges::equal(file.hlod.data().image_materials, std::vector<std::uint8_t>{0, 1}));
  std::size_t leaf_texels = 0, other_texels = 0;
  for (NodeId n = 0; n < built().node_count(); ++n) {
    file.hlod.require(n);
    const hlod::NodeMesh mesh = file.hlod.mesh(n);
    ASSERT_EQ(mesh.image_coordinates.size(), mesh.positions.size());
    const Texels image = decode_texels(mesh.image, "image");
    (built().node(n).level == 0 ? leaf_texels : other_texels) += image.pixels.size();
    const double texel = file.hlod.data().node_images[n].texel_size, source_texel = 64.0 / (0.96 * side);
    EXPECT_EQ(texel == 0.0, built().node(n).level == 0);
    const double most = 2.0 + texel / source_texel;  // a value is a texel of the source
    for (const std::uint16_t v : mesh.indices) {
      const glm::dvec2 at = glm::dvec2(mesh.image_coordinates[v]) / 65535.0 * glm::dvec2(image.width, image.height);
      const glm::ivec2 nearest = glm::clamp(glm::ivec2(at), glm::ivec2(0), glm::ivec2(image.width, image.height) - 1);
      const glm::u8vec4 shown = image.pixels[static_cast<std::size_t>(nearest.y * image.width + nearest.x)];
      const glm::dvec2 wanted = glm::dvec2(mesh.texture_coordinates[v]) * static_cast<double>(side) - 0.5;
      EXPECT_NEAR(shown.r, wanted.x, most) << n;
      EXPECT_NEAR(shown.g, wanted.y, most) << n;
    }
  }
  EXPECT_LT(other_texels, leaf_texels);
  EXPECT_EQ(validate(file.hlod), std::vector<std::string>());
}

// Nodes are drawn only where their texels are no larger than the tolerance, as their errors say.
TEST_P(NodeImages, ErrorsAreNoLessThanTexels) {
  const OhlodFile file = read_ohlod(file_);
  for (NodeId n = 0; n < built().node_count(); ++n) {
    const hlod::Node& node = file.hlod.node(n);
    EXPECT_GE(node.error, file.hlod.data().node_images[n].texel_size);
    EXPECT_GE(node.error, built().node(n).error);
    EXPECT_EQ(node.guaranteed_error, built().node(n).guaranteed_error);
    for (const NodeId child : file.hlod.children(n)) EXPECT_GE(node.child_error, file.hlod.node(child).error);
  }
}

// A file that was read is written as it was, and the same input gives the same file.
TEST_P(NodeImages, TheSameBytes) {
  const OhlodFile file = read_ohlod(file_);
  write_ohlod(folder_ / "again.ohlod", file.hlod, file.report, {.compression = file.compression});
  write_ohlod(folder_ / "anew.ohlod", built(), {}, {.compression = GetParam(), .images = OhlodImages::nodes});
  EXPECT_EQ(bytes_of(folder_ / "again.ohlod"), bytes_of(file_));
  EXPECT_EQ(bytes_of(folder_ / "anew.ohlod"), bytes_of(file_));
}

TEST_P(NodeImages, ComeAndGoWithTheirNodes) {
  const OhlodFile whole = read_ohlod(file_);
  const OhlodFile paged = open_ohlod(file_, {.load = hlod::LoadMode::blocking});
  hlod::NodeStore& store = *paged.hlod.store();
  std::vector<NodeId> all(built().node_count());
  std::iota(all.begin(), all.end(), NodeId{0});
  store.begin_frame();
  ASSERT_TRUE(store.fetch(all));
  std::size_t images = 0;
  for (const NodeId n : all) {
    whole.hlod.require(n);
    const hlod::NodeMesh mesh = paged.hlod.mesh(n), truth = whole.hlod.mesh(n);
    EXPECT_TRUE(std::ranges::equal(mesh.image, truth.image));
    EXPECT_TRUE(std::ranges::equal(mesh.image_coordinates, truth.image_coordinates));
    EXPECT_TRUE(std::ranges::equal(mesh.positions, truth.positions));
    images += mesh.image.size() + 4 * mesh.positions.size();
  }
  EXPECT_GE(store.stats().resident_bytes, images);
}

TEST_P(NodeImages, DamagedOnesAreToldOnceAndTheirNodesStayAway) {
  const NodeId leaf = built().data().levels[0].first_node;
  damage(leaf);
  const std::string name = "image of node " + std::to_string(leaf);
  const OhlodFile whole = read_ohlod(file_);
  EXPECT_NE(error_of([&] { whole.hlod.require(leaf); }).find(name), std::string::npos);
  EXPECT_EQ(error_of([&] { whole.hlod.require(leaf + 1); }), "");
  const OhlodFile paged = open_ohlod(file_, {.load = hlod::LoadMode::blocking});
  hlod::NodeStore& store = *paged.hlod.store();
  store.begin_frame();
  EXPECT_FALSE(store.fetch({&leaf, 1}));
  const std::vector<std::string> failures = store.take_failures();
  ASSERT_EQ(failures.size(), 1U);
  EXPECT_NE(failures[0].find(name), std::string::npos);
  EXPECT_EQ(failures[0].find('\n'), std::string::npos);
  EXPECT_TRUE(store.take_failures().empty());
}

// The file from afar, of which images are fetched along with meshes.
class FarNodeImages : public NodeImages {
 protected:
  FarNodeImages() : content_(bytes_of(file_)) {}

  [[nodiscard]] std::span<const std::byte> bytes(const hlod::ByteRange& range) const {
    return std::as_bytes(std::span(content_)).subspan(range.begin, range.end - range.begin);
  }
  void damage_what_comes(NodeId n) { content_[place_of(n)] ^= 1; }
  [[nodiscard]] std::vector<NodeId> all() const {
    std::vector<NodeId> nodes(built().node_count());
    std::iota(nodes.begin(), nodes.end(), NodeId{0});
    return nodes;
  }
  // Returns how often something was missing.
  int open(hlod::RemoteOhlod& remote) {
    for (int rounds = 0;; ++rounds) {
      const std::vector<hlod::ByteRange> missing = remote.open({});
      if (missing.empty()) return rounds;
      for (const hlod::ByteRange& range : missing) remote.put(range.begin, bytes(range));
      if (rounds > 50) throw std::runtime_error("asks for ever");
    }
  }
  // Frames in which all nodes are wanted until no more requests come, each answered by `answer`.
  static void fetch_all(hlod::RemoteOhlod& remote, const std::vector<NodeId>& nodes,
                        const std::function<void(const hlod::RemoteRequest&)>& answer) {
    hlod::NodeStore& store = *remote.file().hlod.store();
    for (int i = 0; i < 200; ++i) {
      store.begin_frame();
      for (const NodeId n : nodes) store.want({&n, 1}, 1.0);
      store.end_frame();
      while (const auto request = remote.next()) answer(*request);
    }
  }

  std::vector<char> content_;
};

INSTANTIATE_TEST_SUITE_P(Of, FarNodeImages, ::testing::Values(OlodCompression::none, OlodCompression::zstd),
                         [](const auto& of) { return of.param == OlodCompression::none ? "plain" : "packed"; });

// A third of the answers is lost and comes later: for meshes, for images, and for both.
TEST_P(FarNodeImages, AreThoseOfTheFile) {
  hlod::RemoteOhlod remote("far.ohlod", content_.size());
  EXPECT_LE(open(remote), 3);
  int count = 0;
  fetch_all(remote, all(), [&](const hlod::RemoteRequest& request) {
    EXPECT_FALSE(request.again);
    EXPECT_LE(request.range.end - request.range.begin, 2U << 20U);
    if (count++ % 3 == 0) return remote.lose(request.id);
    remote.arrive(request.id, bytes(request.range));
  });
  const OhlodFile whole = read_ohlod(file_);
  for (const NodeId n : all()) {
    whole.hlod.require(n);
    ASSERT_TRUE(remote.file().hlod.is_resident(n)) << n;
    const hlod::NodeMesh mesh = remote.file().hlod.mesh(n), truth = whole.hlod.mesh(n);
    EXPECT_FALSE(mesh.image.empty());
    EXPECT_TRUE(std::ranges::equal(mesh.image, truth.image));
    EXPECT_TRUE(std::ranges::equal(mesh.image_coordinates, truth.image_coordinates));
    EXPECT_TRUE(std::ranges::equal(mesh.positions, truth.positions));
  }
  EXPECT_TRUE(remote.take_cancelled().empty());
  EXPECT_TRUE(remote.take_dropped_images().empty());
}

// A node whose image is lost waits for it, and keeps the mesh that has come.
TEST_P(FarNodeImages, AreWaitedFor) {
  hlod::RemoteOhlod remote("far.ohlod", content_.size());
  open(remote);
  const NodeId child = built().children(built().data().roots[0])[0];
  hlod::NodeStore& store = *remote.file().hlod.store();
  const auto frame = [&](bool is_wanted) {
    store.begin_frame();
    if (is_wanted) store.want({&child, 1}, 1.0);
    store.end_frame();
  };
  frame(true);
  const auto mesh = remote.next(), image = remote.next();
  ASSERT_TRUE(mesh && image);
  EXPECT_FALSE(remote.next());
  remote.arrive(mesh->id, bytes(mesh->range));
  remote.lose(image->id);
  frame(true);
  EXPECT_FALSE(remote.file().hlod.is_resident(child));
  const auto again = remote.next();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->range, image->range);
  EXPECT_FALSE(remote.next());
  frame(false);
  EXPECT_EQ(remote.take_cancelled(), std::vector<std::uint32_t>{again->id});
  EXPECT_EQ(store.stats().loading_bytes, 0U);
  frame(true);
  for (int i = 0; i < 2; ++i) {
    const auto request = remote.next();
    ASSERT_TRUE(request);
    remote.arrive(request->id, bytes(request->range));
  }
  frame(true);
  EXPECT_TRUE(remote.file().hlod.is_resident(child));
}

// Damage that stays costs a node its image, and says so once; it is asked for again before. That of a root is not.
TEST_P(FarNodeImages, DamagedOnesLeaveTheirNodes) {
  const NodeId leaf = built().data().levels[0].first_node, root = built().data().roots[0];
  for (const bool heals : {true, false}) {
    hlod::RemoteOhlod remote("far.ohlod", content_.size());
    open(remote);
    damage_what_comes(leaf);
    int again = 0;
    fetch_all(remote, all(), [&](const hlod::RemoteRequest& request) {
      if (request.again && again++ == 0 && heals) damage_what_comes(leaf);
      remote.arrive(request.id, bytes(request.range));
    });
    if (!heals) damage_what_comes(leaf);
    EXPECT_EQ(again, 2) << "mesh and image";
    ASSERT_TRUE(remote.file().hlod.is_resident(leaf));
    const hlod::NodeMesh mesh = remote.file().hlod.mesh(leaf);
    EXPECT_EQ(std::ranges::all_of(mesh.image, [](std::uint8_t byte) { return byte == 0; }), !heals);
    const std::vector<std::string> lines = remote.take_dropped_images();
    ASSERT_EQ(lines.size(), heals ? 0U : 1U);
    if (!heals) {
      EXPECT_TRUE(lines[0].starts_with("far.ohlod: image of node " + std::to_string(leaf) + ": is damaged"));
    }
    EXPECT_EQ(remote.file().hlod.store()->stats().failed, 0U);
  }
  damage_what_comes(root);
  hlod::RemoteOhlod remote("far.ohlod", content_.size());
  open(remote);
  EXPECT_TRUE(remote.file().hlod.is_resident(root));
  EXPECT_EQ(remote.take_dropped_images().size(), 1U);
}

// A table that leads outside of the images is refused before anything is read there.
TEST(NodeImageTable, MustLieWithinTheImages) {
  Folder folder;
  const std::filesystem::path file = folder / "hills.ohlod";
  write_ohlod(file, built(), {}, {.images = OhlodImages::nodes});
  const OhlodFile good = read_ohlod(file);
  hlod::HlodData data = copy_data(good.hlod);
  EXPECT_FALSE(check_structure(view_of(data)));
  data.node_images[1].place = data.images.size();
  EXPECT_TRUE(check_structure(view_of(data)));
  data = copy_data(good.hlod);
  data.node_images.pop_back();
  EXPECT_TRUE(check_structure(view_of(data)));
  data = copy_data(good.hlod);
  data.node_images[1].bytes = 4 * data.nodes[1].vertices;  // coordinates, and no image behind them
  EXPECT_TRUE(check_structure(view_of(data)));
}

TEST(NodeImageTable, IsThereOnRequestAlone) {
  Folder folder;
  write_ohlod(folder / "named.ohlod", built(), {});
  const OhlodFile named = read_ohlod(folder / "named.ohlod");
  EXPECT_TRUE(named.hlod.data().node_images.empty());
  EXPECT_LT(named.version, ohlod_version);
  named.hlod.require(0);
  EXPECT_TRUE(named.hlod.mesh(0).image.empty());
}

// The progress of images begins at 0 and rises to less than 1, and what it throws leaves no file.
TEST(NodeImageProgress, RisesAndMayEndIt) {
  Folder folder;
  std::vector<double> shares;
  OhlodOptions options;
  options.images = OhlodImages::nodes;
  options.images_progress = [&](double done) { shares.push_back(done); };
  write_ohlod(folder / "hills.ohlod", built(), {}, options);
  ASSERT_GT(shares.size(), built().node_count());
  EXPECT_EQ(shares.front(), 0.0);
  EXPECT_TRUE(std::ranges::is_sorted(shares));
  EXPECT_GT(shares.back(), 0.9);
  EXPECT_LT(shares.back(), 1.0);
  options.images_progress = [](double done) {
    if (done > 0.5) throw std::runtime_error("enough");
  };
  EXPECT_THROW(write_ohlod(folder / "never.ohlod", built(), {}, options), std::runtime_error);
  EXPECT_FALSE(std::filesystem::exists(folder / "never.ohlod"));
}

// Images of nodes are written in another format where that is asked for.
TEST(NodeImageTiles, MayBeEncodedAnew) {
  Folder folder;
  write_ohlod(folder / "hills.ohlod", tiles::test::nested_hlod(hills(), 256), {}, {.images = OhlodImages::nodes});
  tiles::TilesetOptions options;
  options.texture_format = tiles::TextureFormat::jpeg;
  tiles::write_tileset(folder / "tiles", read_ohlod(folder / "hills.ohlod").hlod, options);
  const TriangleMesh tile = tiles::test::read_content(folder / ("tiles/" + tiles::content_name(0)));
  EXPECT_EQ(tile.textures.at(0).mime_type, "image/jpeg");
}

}  // namespace
}  // namespace occlod
