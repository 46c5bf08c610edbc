#include "hlod/store/node_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "hlod/store/hlod_data.h"

namespace occlod::ohlod {
namespace {

using hlod::HlodData;

// One node with arbitrary bytes in all of its arrays, and splits.
class NodeCodecTest : public ::testing::Test {
 protected:
  explicit NodeCodecTest(std::uint32_t vertices = 500, std::uint32_t triangles = 900) {
    data_.has_normals = data_.has_colors = data_.has_texture_coordinates = data_.has_materials = true;
    data_.nodes.resize(1);
    data_.nodes[0].vertices = vertices;
    data_.nodes[0].triangles = triangles;
    data_.within = {{0, 300, 20, triangles, 0}};
    data_.meshes.assign(hlod::align_mesh(mesh_layout().bytes), std::byte{0});
    data_.splits.resize(hlod::align_mesh(splits_layout().bytes));
  }

  [[nodiscard]] hlod::MeshLayout mesh_layout() const { return {data_.nodes[0], arrays_of(data_)}; }
  [[nodiscard]] hlod::SplitsLayout splits_layout() const { return {data_.within[0], arrays_of(data_)}; }

  static void fill_randomly(std::span<std::byte> bytes) {
    std::mt19937 random(7);
    for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  }
  // `value(i)`: of each coordinate of all vertices.
  void set_positions(const std::function<float(std::size_t)>& value) {
    for (std::size_t i = 0; i < 3 * std::size_t{data_.nodes[0].vertices}; ++i) {
      const float coordinate = value(i);
      std::memcpy(data_.meshes.data() + 4 * i, &coordinate, 4);
    }
  }
  [[nodiscard]] LargeVector<std::byte> pack() {
    LargeVector<std::byte> packed;
    NodePacker().pack_mesh(view_of(data_), 0, packed);
    return packed;
  }
  // Bytes of a mesh, packed; 0 when it does not come back as it was.
  [[nodiscard]] std::size_t packed_bytes() {
    const LargeVector<std::byte> packed = pack();
    std::vector<std::byte> raw(data_.meshes.size(), std::byte{0xaa});
    const bool is_whole = NodeUnpacker().unpack_mesh(view_of(data_), 0, packed, raw);
    return is_whole && std::ranges::equal(raw, data_.meshes) ? packed.size() : 0;
  }

  HlodData data_;
};

TEST_F(NodeCodecTest, AnyBytesComeBack) {
  fill_randomly(std::span(data_.meshes).first(mesh_layout().bytes));
  EXPECT_GT(packed_bytes(), 0U);

  const hlod::SplitsLayout layout = splits_layout();
  fill_randomly(std::span(data_.splits).first(layout.bytes));
  std::fill(data_.splits.begin() + static_cast<std::ptrdiff_t>(layout.end),
            data_.splits.begin() + static_cast<std::ptrdiff_t>(layout.errors), std::byte{0});
  LargeVector<std::byte> packed;
  NodePacker().pack_splits(view_of(data_), 0, packed);
  std::vector<std::byte> raw(data_.splits.size(), std::byte{0xaa});
  EXPECT_TRUE(NodeUnpacker().unpack_splits(view_of(data_), 0, packed, raw));
  EXPECT_TRUE(std::ranges::equal(raw, data_.splits));
}

TEST_F(NodeCodecTest, AnyPositionsComeBack) {
  std::mt19937 random(5);
  using Limits = std::numeric_limits<float>;
  const float special[] = {0.0F,
                           -0.0F,
                           1.0F,
                           -1.0F,
                           Limits::max(),
                           Limits::lowest(),
                           Limits::min(),
                           Limits::denorm_min(),
                           Limits::infinity(),
                           Limits::quiet_NaN(),
                           0.1F,
                           8388609.0F,
                           3e-30F,
                           16777215.0F};
  set_positions([&](std::size_t) { return special[random() % std::size(special)]; });
  EXPECT_GT(packed_bytes(), 0U);
  // Each with whole numbers, so that there is a lattice for some.
  for (const float value : special) {
    set_positions([&](std::size_t i) { return i == 77 ? value : static_cast<float>(random() % 1000) - 500.0F; });
    EXPECT_GT(packed_bytes(), 0U) << value;
    set_positions([&](std::size_t) { return value; });
    EXPECT_GT(packed_bytes(), 0U) << value;
  }
  for (int exponent = -150; exponent < 128; ++exponent) {  // lattices of all steps, some of which floats do not have
    set_positions([&](std::size_t) { return std::ldexp(static_cast<float>(random() % 5000) - 2500.0F, exponent); });
    EXPECT_GT(packed_bytes(), 0U) << exponent;
  }
}

// What lies on a lattice takes the bytes of its whole numbers, wherever exponents of floats change.
TEST_F(NodeCodecTest, LatticesArePackedBetter) {
  std::mt19937 random(9);
  std::vector<float> steps;
  for (std::size_t i = 0; i < 3 * std::size_t{data_.nodes[0].vertices}; ++i)
    steps.push_back(static_cast<float>(random() % 128) - 64.0F);
  set_positions([&](std::size_t i) { return steps[i] / 1024.0F; });
  const std::size_t lattice = packed_bytes();
  set_positions([&](std::size_t i) { return steps[i] / 1000.0F; });
  const std::size_t floats = packed_bytes();
  EXPECT_GT(lattice, 0U);
  EXPECT_LT(2 * lattice, floats);
}

TEST_F(NodeCodecTest, AllLinksComeBack) {
  const std::size_t first = mesh_layout().merged_into;
  std::mt19937 random(3);
  for (int run = 0; run < 200; ++run) {
    for (std::size_t i = 0; i < data_.nodes[0].vertices; ++i) {
      const auto link = static_cast<std::uint16_t>(random() % 3 == 0 ? 0xffff - random() % 3 : random());
      std::memcpy(data_.meshes.data() + first + 2 * i, &link, 2);
    }
    ASSERT_GT(packed_bytes(), 0U);
  }
}

// Equal bytes are packed 1000 times at most, so that no small file claims a large memory.
class LargeNodeCodecTest : public NodeCodecTest {
 protected:
  LargeNodeCodecTest() : NodeCodecTest(60'000, 1'000'000) {}
};

TEST_F(LargeNodeCodecTest, NeverPacksTooWell) {
  const std::size_t packed = packed_bytes();
  EXPECT_GT(packed, 0U);
  EXPECT_EQ(packed, (data_.meshes.size() + max_packing - 1) / max_packing);
}

// Never writes outside its memory, which sanitizers see, and ends.
TEST_F(NodeCodecTest, DamageIsSurvived) {
  std::mt19937 random(1);
  set_positions([&](std::size_t) { return static_cast<float>(random() % 1000); });
  const LargeVector<std::byte> good = pack();
  std::vector<std::byte> raw(data_.meshes.size());
  NodeUnpacker unpacker;
  int refused = 0;
  for (int run = 0; run < 5000; ++run) {
    LargeVector<std::byte> bad = good;
    for (std::uint32_t n = 0; n <= static_cast<std::uint32_t>(run % 3); ++n)
      bad[random() % bad.size()] = static_cast<std::byte>(random());
    if (run % 4 == 0) bad.resize(random() % bad.size());
    refused += unpacker.unpack_mesh(view_of(data_), 0, bad, raw) ? 0 : 1;
  }
  EXPECT_GT(refused, 2000);
  ASSERT_TRUE(unpacker.unpack_mesh(view_of(data_), 0, good, raw)) << "it can be used again";
  EXPECT_TRUE(std::ranges::equal(raw, data_.meshes));
}

}  // namespace
}  // namespace occlod::ohlod
