#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "io/mesh_files.h"

namespace occlod {
namespace {

using namespace std::string_literals;

// ASCII as UTF-16.
std::string utf16(const std::string& ascii, std::endian order, bool mark = true) {
  test::Bytes bytes({}, order);
  if (mark) bytes.add(std::uint16_t{0xfeff});
  for (const char c : ascii) bytes.add(static_cast<std::uint16_t>(c));
  return bytes.str();
}

const std::string obj = "# a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string ply =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const std::string stl =
    "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
    "s\n";
const std::vector<std::pair<std::string, std::string>> texts = {
    {"a.obj", obj}, {"a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"}, {"a.ply", ply}, {"a.stl", stl}};

TEST(TextEncoding, EveryTextFormatIsReadInUtf8AndUtf16) {
  const test::TestFolder folder;
  for (const auto& [name, text] : texts) {
    for (const std::string& bytes :
         {"\xef\xbb\xbf" + text, utf16(text, std::endian::little), utf16(text, std::endian::big),
          utf16(text, std::endian::little, false), utf16(text, std::endian::big, false)}) {
      const CleanMesh result = folder.read(name, bytes);
      EXPECT_EQ(result.mesh.positions, (std::vector<glm::vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})) << name;
      EXPECT_EQ(result.mesh.triangles, (std::vector<Triangle>{{0, 1, 2}})) << name;
    }
  }
}

TEST(TextEncoding, LinesAreCountedInAnyEncoding) {
  const test::TestFolder folder;
  const std::string text = obj + "f 1 2 4\n";
  EXPECT_CONTAINS(folder.complaint("a.obj", utf16(text, std::endian::little)), "line 6: a face uses vertex 4");
  EXPECT_CONTAINS(folder.complaint("a.obj", "\xef\xbb\xbf" + text), "line 6: a face uses vertex 4");
}

TEST(TextEncoding, SaysWhatCannotBeRead) {
  const test::TestFolder folder;
  const std::string text = utf16(obj, std::endian::little);
  EXPECT_EQ(folder.complaint("a.obj", text.substr(0, text.size() - 1)),
            "byte " + std::to_string(text.size() - 2) + ": is UTF-16 text that ends within a character");
  EXPECT_EQ(folder.complaint("a.obj", "\xff\xfe\0\0v\0\0\0"s), ": is UTF-32 text");
  EXPECT_EQ(folder.complaint("a.obj", "\0\0\xfe\xff\0\0\0v"s), ": is UTF-32 text");
}

// Characters of one to four bytes in UTF-8: A, e with acute accent, the euro sign, and U+1F600, whose surrogates are
// D83D DE00. Half of a pair becomes U+FFFD.
TEST(TextEncoding, ConvertsCharactersOfEveryLength) {
  const FileErrors errors("a");
  for (const std::endian order : {std::endian::little, std::endian::big}) {
    test::Bytes bytes({}, order);
    for (const int unit : {0xfeff, 0x41, 0xe9, 0x20ac, 0xd83d, 0xde00, 0xd83d, 0x42, 0xde00, 0xd83d})
      bytes.add(static_cast<std::uint16_t>(unit));
    std::string converted;
    EXPECT_EQ(as_utf8(bytes.str(), converted, errors),
              "A\xc3\xa9\xe2\x82\xac\xf0\x9f\x98\x80\xef\xbf\xbd"
              "B\xef\xbf\xbd\xef\xbf\xbd");
  }
}

// UTF-8 stays as it is; overlong forms, surrogates, what is beyond Unicode and what is cut short are bytes, and so are
// the characters that stand for bytes.
TEST(TextEncoding, AnyBytesGoRoundAsUtf8) {
  for (const std::string& text : {""s, "plain"s, "Stra\xc3\x9f\x65"s, "\xf0\x9f\x99\x82"s, "\n\x01\x7f"s, "a\0b"s})
    EXPECT_EQ(utf8_of_bytes(text), text);
  EXPECT_EQ(utf8_of_bytes("a\xff"), "a\xf4\x8f\xbf\xbf");  // U+10FFFF
  for (const std::string& bytes : {"\xff"s, "Stra\xdf\x65"s, "\xc0\x80"s, "\xed\xa0\x80"s, "\xf4\x90\x80\x80"s,
                                   "\xe2\x82"s, "\xf4\x8f\xbc\x80"s, "\xf4\x8f\xbf\xbf\xff"s}) {
    const std::string text = utf8_of_bytes(bytes);
    EXPECT_NE(text, bytes);
    EXPECT_EQ(bytes_of_utf8(text), bytes);
  }
  std::string all;
  for (int c = 0; c < 256; ++c) all += static_cast<char>(c);
  EXPECT_EQ(bytes_of_utf8(utf8_of_bytes(all)), all);
}

// Binary STL may begin with any bytes.
TEST(TextEncoding, BinaryFilesAreLeftAlone) {
  const test::TestFolder folder;
  for (const std::string& beginning : {"\xff\xfe"s, "\xef\xbb\xbf"s, "a\0b\0"s}) {
    std::string head = beginning;
    head.resize(80, ' ');
    test::Bytes bytes(head);
    bytes.add(std::uint32_t{1}).add_point(0, 0, 1).add_point(0, 0, 0).add_point(1, 0, 0).add_point(0, 1, 0);
    bytes.add(std::uint16_t{0});
    EXPECT_EQ(folder.read("a.stl", bytes.str()).mesh.triangle_count(), 1u);
  }
}

}  // namespace
}  // namespace occlod
