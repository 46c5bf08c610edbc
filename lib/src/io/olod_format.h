// The parts that writing and reading .olod files share.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "occlod/hierarchy/hierarchy.h"
#include "occlod/mesh/mesh_report.h"

namespace occlod::olod {

static_assert(std::endian::native == std::endian::little, ".olod files are little-endian and read as they are");

// The carriage returns and the end-of-file byte reveal a transfer in text mode, as in PNG.
inline constexpr std::array<char, 8> magic = {'O', 'L', 'O', 'D', '\r', '\n', '\x1a', '\n'};
inline constexpr std::uint64_t alignment = 64;  // of every section
inline constexpr std::uint32_t most_sections = 64;
inline constexpr const char* rebuild = "build it again with 'occlod build'";

struct FileHeader {
  std::array<char, 8> magic{};
  std::uint32_t version = 0;
  std::uint32_t section_count = 0;
  std::uint64_t file_bytes = 0;
  std::uint64_t table_checksum = 0;  // XXH3-64 of the section table
};
static_assert(sizeof(FileHeader) == 32);

enum class Codec : std::uint32_t { stored = 0, zstd = 1 };

struct Section {
  std::array<char, 4> name{};
  std::uint32_t element_bytes = 0;
  std::uint64_t offset = 0;     // from the start of the file
  std::uint64_t bytes = 0;      // in the file
  std::uint64_t raw_bytes = 0;  // unpacked; the same when stored
  std::uint64_t checksum = 0;   // XXH3-64 of the unpacked section; 0 for those whose blocks have their own
  Codec codec = Codec::stored;
  std::uint32_t reserved = 0;
};
static_assert(sizeof(Section) == 48);

// Everything in a hierarchy that is not an array.
struct Summary {
  Box box;
  std::uint64_t input_triangle_count = 0;
  std::uint64_t face_count = 0;
  float error_bound = 0.0F;
  std::uint32_t reserved = 0;
};
static_assert(sizeof(Summary) == 48);

// The counts of a MeshReport without what was left out. That is a section of its own, a LeftOut, which is there only
// when one of its numbers is not 0.
using StoredReport = std::array<std::uint64_t, 16>;
static_assert(offsetof(MeshReport, left_out) == sizeof(StoredReport));
static_assert(sizeof(MeshReport) == sizeof(StoredReport) + sizeof(LeftOut) && sizeof(LeftOut) == 40);

inline constexpr std::string_view summary_name = "INFO", report_name = "REPO", digests_name = "BLOK",
                                  left_out_name = "LEFT";

// Calls visit(name, array, has_blocks) for every array of a hierarchy: the one list of what a file holds. Those with
// blocks are checked block by block.
template <typename View, typename Visit>
void for_each_array(View& view, const Visit& visit) {
  visit("POSI", view.positions, true);
  visit("NORM", view.normals, true);
  visit("COLR", view.colors, true);
  visit("NODE", view.nodes, true);
  visit("STAR", view.stars, true);
  visit("ROOT", view.roots, false);
  visit("BASE", view.base_faces, false);
}

[[nodiscard]] std::uint64_t checksum_of(std::span<const std::byte> bytes);

// XXH3-64 of what belongs to the base vertices: positions, normals, colors.
[[nodiscard]] std::uint64_t digest_of_base(const HierarchyView& view);
// And of what belongs to a block of SplitGuard::block_size splits: nodes, stars, positions, normals, colors. The places
// of the stars have been checked.
[[nodiscard]] std::uint64_t digest_of_block(const HierarchyView& view, std::size_t block);

struct BlockRange {
  std::size_t first, end;  // splits
};
[[nodiscard]] BlockRange range_of_block(const HierarchyView& view, std::size_t block);

}  // namespace occlod::olod
