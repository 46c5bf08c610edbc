// Making images of nodes that goes on where it was interrupted.
#include "hlod/texture/image_journal.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "hlod/store/hlod_data.h"
#include "mesh/image_codec.h"
#include "occlod/build_hlod.h"
#include "occlod/node_store.h"
#include "support/error_of.h"
#include "tile_support.h"

namespace occlod::hlod {
namespace {

using occlod::test::error_of;
using tiles::test::Folder;

constexpr int side = 128;

// A wavy sheet with an image that is a stripe of `blue`.
Hlod sheet(std::uint8_t blue) {
  TriangleMesh mesh = tiles::test::wavy_sheet(48, 1.0F);
  mesh.materials.resize(1);
  mesh.materials[0].texture = 0;
  std::vector<glm::u8vec4> pixels;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) pixels.emplace_back(x, y, x < 9 ? blue : 0, 255);
  mesh.textures.resize(1);
  mesh.textures[0].mime_type = "image/png";
  mesh.textures[0].bytes = encode_png(pixels, side);
  HlodBuildOptions options;
  options.node_triangles = 128;
  return build_hlod(mesh, options);
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class Images : public ::testing::Test {
 protected:
  // The bytes of the .ohlod file; they are those without a journal where it does what it should.
  [[nodiscard]] std::string written(const Hlod& hlod, int threads = 1) const {
    write_ohlod(folder_ / "a.ohlod", hlod, {},
                {.images = OhlodImages::nodes, .threads = threads, .images_journal = journal_});
    return bytes_of(folder_ / "a.ohlod");
  }
  [[nodiscard]] std::size_t kept(const Hlod& hlod) const {
    ImageJournal journal(journal_, hlod, {});
    ImagePart part;
    std::size_t count = 0;
    while (journal.take(part)) ++count;
    return count;
  }
  void write_journal(const std::string& bytes) const {
    std::filesystem::remove(journal_);
    std::ofstream(journal_, std::ios::binary) << bytes;
  }

  Folder folder_;
  std::filesystem::path journal_ = folder_ / "a.images.journal";
  Hlod hlod_ = sheet(1);
};

TEST_F(Images, HaveTheSameBytesWhereverTheJournalEnds) {
  write_ohlod(folder_ / "plain.ohlod", hlod_, {}, {.images = OhlodImages::nodes});
  const std::string plain = bytes_of(folder_ / "plain.ohlod");
  EXPECT_EQ(written(hlod_), plain);
  EXPECT_EQ(kept(hlod_), hlod_.node_count());
  const std::string whole = bytes_of(journal_);
  std::size_t last = 0;
  for (std::size_t size = 0; size <= whole.size(); size += whole.size() / 7) {
    write_journal(whole.substr(0, size));
    const std::size_t count = kept(hlod_);
    EXPECT_GE(count, last);
    last = count;
    write_journal(whole.substr(0, size));
    EXPECT_EQ(written(hlod_, 3), plain) << size;
    EXPECT_EQ(kept(hlod_), hlod_.node_count());
  }
  EXPECT_GT(last, hlod_.node_count() / 2);
}

// What a damaged record and those behind it say is made again.
TEST_F(Images, AreMadeAgainFromDamageOn) {
  const std::string plain = written(hlod_);
  std::string damaged = bytes_of(journal_);
  damaged[damaged.size() / 2] ^= 1;
  write_journal(damaged);
  const std::size_t count = kept(hlod_);
  EXPECT_GT(count, 0U);
  EXPECT_LT(count, hlod_.node_count());
  EXPECT_EQ(written(hlod_), plain);
}

// A texel size that no image has shows where an image comes from.
TEST_F(Images, ComeFromTheJournal) {
  {
    ImageJournal journal(journal_, hlod_, {});
    ImagePart part;
    EXPECT_FALSE(journal.take(part));
    part.texel_size = 1234.5;
    journal.append(part);
  }
  (void)written(hlod_);
  const OhlodFile file = read_ohlod(folder_ / "a.ohlod");
  EXPECT_EQ(file.hlod.data().node_images[0].texel_size, 1234.5F);
  EXPECT_LT(file.hlod.data().node_images[1].texel_size, 100.0F);
}

TEST_F(Images, OfOtherInputAreRemoved) {
  (void)written(hlod_);
  EXPECT_EQ(kept(sheet(2)), 0U);
  EXPECT_EQ(kept(hlod_), 0U);
}

TEST_F(Images, LeaveOtherFilesAlone) {
  const std::string other = "this is no journal";
  write_journal(other);
  const std::string error = error_of([&] { (void)written(hlod_); });
  EXPECT_NE(error.find("a.images.journal: is not a journal of images"), std::string::npos) << error;
  EXPECT_EQ(bytes_of(journal_), other);
}

TEST_F(Images, BelongToOneWritingAtATime) {
  const ImageJournal journal(journal_, hlod_, {});
  const std::string error = error_of([&] { (void)written(hlod_); });
  EXPECT_NE(error.find("another build uses it"), std::string::npos) << error;
}

}  // namespace
}  // namespace occlod::hlod
