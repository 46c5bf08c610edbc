// The container of archives: what APPNOTE 6.3.9 and RFC 1321 say of bytes. tests/tools/archive_test.py reads whole
// archives by Python's own readers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hlod/tiles/md5.h"
#include "hlod/tiles/zip_writer.h"

namespace occlod::tiles {
namespace {

std::string hexadecimal(const std::array<std::uint8_t, 16>& digest) {
  std::string text;
  for (const std::uint8_t byte : digest) text += {"0123456789abcdef"[byte >> 4U], "0123456789abcdef"[byte & 15U]};
  return text;
}

// The test suite of RFC 1321, section A.5: its texts end on both sides of the 56 bytes that fit before the length.
TEST(Md5, TestSuite) {
  const std::pair<const char*, const char*> suite[] = {
      {"", "d41d8cd98f00b204e9800998ecf8427e"},
      {"a", "0cc175b9c0f1b6a831c399e269772661"},
      {"abc", "900150983cd24fb0d6963f7d28e17f72"},
      {"message digest", "f96b697d7cb7938d525a2f31aaf161d0"},
      {"abcdefghijklmnopqrstuvwxyz", "c3fcd3d76192e4007dfb496cca67e13b"},
      {"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789", "d174ab98d277d9f5a5611c2c9f419d9f"},
      {"12345678901234567890123456789012345678901234567890123456789012345678901234567890",
       "57edf4a22be3c955ac49da2e2107b67a"},
  };
  for (const auto& [text, digest] : suite) EXPECT_EQ(hexadecimal(md5(text)), digest) << text;
}

// Keeps the last bytes of a file: those of an archive of more than 4 GB fit into no memory.
class Tail {
 public:
  [[nodiscard]] ZipWriter::Write writer() {
    return [this](std::span<const std::byte> bytes) {
      size_ += bytes.size();
      const auto last = bytes.last(std::min(bytes.size(), kept));
      bytes_.insert(bytes_.end(), last.begin(), last.end());
      if (bytes_.size() > kept) bytes_.erase(bytes_.begin(), bytes_.end() - static_cast<std::ptrdiff_t>(kept));
    };
  }
  // Reads a number at a distance from the end.
  template <class Number>
  [[nodiscard]] Number at(std::size_t before_end) const {
    Number number{};
    std::memcpy(&number, bytes_.data() + bytes_.size() - before_end, sizeof(number));
    return number;
  }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }

 private:
  static constexpr std::size_t kept = 400;
  std::vector<std::byte> bytes_;
  std::uint64_t size_ = 0;
};

constexpr std::size_t end_bytes = 22, locator_bytes = 20, end_64_bytes = 56;

std::span<const std::byte> as_bytes(const std::string& text) { return std::as_bytes(std::span(text)); }

TEST(ZipWriter, SmallFile) {
  Tail tail;
  ZipWriter zip(tail.writer());
  EXPECT_EQ(zip.add("check", as_bytes("123456789")), 0U);
  EXPECT_EQ(zip.add("b", {}), 30U + 5 + 9);  // behind a header of 30 bytes, the name and the content
  zip.finish();
  // Two entries of 46 bytes and a name each; nothing of 64 bits.
  EXPECT_EQ(zip.size(), tail.size());
  EXPECT_EQ(tail.size(), (30U + 5 + 9) + (30 + 1) + (46 + 5) + (46 + 1) + end_bytes);
  EXPECT_EQ(tail.at<std::uint32_t>(end_bytes), 0x06054b50U);
  EXPECT_EQ(tail.at<std::uint16_t>(end_bytes - 10), 2U);
  EXPECT_EQ(tail.at<std::uint32_t>(end_bytes - 12), 46U + 5 + 46 + 1);
  EXPECT_EQ(tail.at<std::uint32_t>(end_bytes - 16), 30U + 5 + 9 + 30 + 1);
  const std::size_t first = end_bytes + 46 + 1 + 46 + 5;  // of the directory
  EXPECT_EQ(tail.at<std::uint32_t>(first), 0x02014b50U);
  EXPECT_EQ(tail.at<std::uint32_t>(first - 16), 0xcbf43926U);  // CRC-32 of "123456789", its check value
}

// 65,535 in 16 bits says that the number is in the record of 64 bits.
TEST(ZipWriter, ManyEntries) {
  for (const std::uint64_t entries : {65'534U, 65'535U, 70'000U}) {
    Tail tail;
    ZipWriter zip(tail.writer());
    for (std::uint64_t i = 0; i < entries; ++i) zip.add("a" + std::to_string(i), {});
    const std::uint64_t directory = zip.size();
    zip.finish();
    EXPECT_EQ(tail.at<std::uint16_t>(end_bytes - 10), std::min<std::uint64_t>(entries, 65'535));
    const std::size_t end_64 = end_bytes + locator_bytes + end_64_bytes;
    EXPECT_EQ(tail.at<std::uint32_t>(end_64) == 0x06064b50U, entries >= 65'535);
    if (entries < 65'535) continue;
    EXPECT_EQ(tail.at<std::uint64_t>(end_64 - 32), entries);
    EXPECT_EQ(tail.at<std::uint64_t>(end_64 - 48), directory);
    EXPECT_EQ(tail.at<std::uint64_t>(end_bytes + locator_bytes - 8), tail.size() - end_64);
  }
}

// Beyond 4 GB offsets have 64 bits, in a further field of the directory; that of the entry before has 32.
TEST(ZipWriter, LargeFile) {
  Tail tail;
  ZipWriter zip(tail.writer());
  const std::vector<std::byte> large(std::size_t{1} << 30U);
  for (const char* const name : {"a", "b", "c", "d"}) zip.add(name, large);
  const std::uint64_t far = zip.add("far", {});
  EXPECT_EQ(far, 4 * ((std::uint64_t{1} << 30U) + 31));
  const std::uint64_t directory = zip.size();
  zip.finish();
  const std::size_t end_64 = end_bytes + locator_bytes + end_64_bytes, entry = end_64 + 46 + 3 + 12;
  EXPECT_EQ(tail.at<std::uint32_t>(entry), 0x02014b50U);
  EXPECT_EQ(tail.at<std::uint16_t>(entry - 6), 45U);           // version needed to read it
  EXPECT_EQ(tail.at<std::uint32_t>(entry - 42), 0xffffffffU);  // offset
  EXPECT_EQ(tail.at<std::uint16_t>(entry - 49), 1U);           // the field of 64 bits
  EXPECT_EQ(tail.at<std::uint16_t>(entry - 51), 8U);
  EXPECT_EQ(tail.at<std::uint64_t>(entry - 53), far);
  const std::size_t before = entry + 46 + 1;
  EXPECT_EQ(tail.at<std::uint32_t>(before), 0x02014b50U);
  EXPECT_EQ(tail.at<std::uint32_t>(before - 42), 3 * ((std::uint64_t{1} << 30U) + 31));
  EXPECT_EQ(tail.at<std::uint32_t>(end_bytes - 16), 0xffffffffU);
  EXPECT_EQ(tail.at<std::uint64_t>(end_64 - 48), directory);
}

}  // namespace
}  // namespace occlod::tiles
