#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "hierarchy/split_guard.h"
#include "hierarchy/structure.h"
#include "mapped_file.h"
#include "occlod/core/error.h"
#include "occlod/io/olod.h"
#include "olod_codec.h"
#include "olod_format.h"

namespace occlod {
namespace {

using namespace olod;

std::string_view name_of(const Section& section) { return {section.name.data(), section.name.size()}; }
std::string place_of(const Section& section) {
  return fmt::format("section {} at byte {}", name_of(section), section.offset);
}

// Owns what a hierarchy refers to: the mapping or copy of the file, and the sections that had to be decompressed.
class Reader {
 public:
  Reader(const std::filesystem::path& path, OlodAccess access) : path_(path.string()) {
    if (access == OlodAccess::mapped) {
      bytes_ = file_.emplace(path).bytes();
    } else {
      copy_ = read_whole(path);
      bytes_ = copy_;
    }
    read_header();
    read_table();
  }

  [[noreturn]] void refuse(const std::string& place, const std::string& problem, const std::string& remedy) const {
    throw Error({path_, place, problem, remedy});
  }

  // Elements of a section, in the mapping or decompressed. Only sections without blocks are checked here.
  template <typename T>
  std::span<const T> read(std::string_view name, bool has_blocks) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= alignment);
    const auto found = find(name);
    if (found == table_.end()) refuse("", fmt::format("has no section {}", name), rebuild);
    if (found->element_bytes != sizeof(T) || found->raw_bytes % sizeof(T) != 0)
      refuse(place_of(*found), "has elements of the wrong size", rebuild);
    const std::span<const std::byte> bytes = found->codec == Codec::stored ? stored(*found) : unpacked(*found);
    if (!has_blocks && checksum_of(bytes) != found->checksum)
      refuse(place_of(*found), "is damaged: its checksum is wrong", rebuild);
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }

  [[nodiscard]] bool has(std::string_view name) const { return find(name) != table_.end(); }
  [[nodiscard]] bool is_compressed() const noexcept { return !unpacked_.empty(); }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  void read_header() {
    FileHeader header;
    if (bytes_.size() >= sizeof(header)) std::memcpy(&header, bytes_.data(), sizeof(header));
    if (header.magic != magic) refuse("byte 0", "is not an .olod file", "make one with 'occlod build'");
    if (header.version != olod_version)
      refuse("byte 8",
             fmt::format("is an .olod file of version {}, this program reads version {}", header.version, olod_version),
             rebuild);
    if (header.file_bytes != bytes_.size())
      refuse("byte 16",
             fmt::format("has {} bytes, but says that it has {}: it is truncated or has extra bytes", bytes_.size(),
                         header.file_bytes),
             rebuild);
    if (header.section_count > most_sections)
      refuse("byte 12", fmt::format("claims {} sections", header.section_count), rebuild);
    table_.resize(header.section_count);
    const auto table = std::as_writable_bytes(std::span(table_));
    if (bytes_.size() - sizeof(header) < table.size()) refuse("byte 32", "ends inside its section table", rebuild);
    std::ranges::copy(bytes_.subspan(sizeof(header), table.size()), table.begin());
    if (checksum_of(table) != header.table_checksum)
      refuse("byte 32", "has a damaged section table: its checksum is wrong", rebuild);
  }

  void read_table() const {
    const std::uint64_t size = bytes_.size();
    for (const Section& section : table_) {
      if (section.offset > size || section.bytes > size - section.offset)
        refuse(place_of(section), "lies outside the file", rebuild);
      if (section.offset % alignment != 0) refuse(place_of(section), "does not start at a multiple of 64", rebuild);
      if (section.codec != Codec::stored && section.codec != Codec::zstd)
        refuse(place_of(section),
               fmt::format("is compressed with the unknown codec {}", static_cast<std::uint32_t>(section.codec)),
               "use a newer program");
      if (section.codec == Codec::stored && section.bytes != section.raw_bytes)
        refuse(place_of(section), "has a size that contradicts the table", rebuild);
      if (!is_plausible(section.bytes, section.raw_bytes))
        refuse(place_of(section), fmt::format("claims {} bytes after decompression", section.raw_bytes), rebuild);
    }
  }

  [[nodiscard]] std::vector<Section>::const_iterator find(std::string_view name) const {
    return std::find_if(table_.begin(), table_.end(), [&](const Section& s) { return name_of(s) == name; });
  }

  [[nodiscard]] std::span<const std::byte> stored(const Section& section) const {
    return bytes_.subspan(section.offset, section.bytes);
  }

  std::span<const std::byte> unpacked(const Section& section) {
    std::vector<std::byte>& raw = unpacked_.emplace_back(section.raw_bytes);
    if (!unpack(stored(section), section.element_bytes, raw))
      refuse(place_of(section), "is damaged: it cannot be decompressed", rebuild);
    return raw;
  }

  std::string path_;
  std::optional<MappedFile> file_;  // or a copy
  LargeVector<std::byte> copy_;
  std::span<const std::byte> bytes_;
  std::vector<Section> table_;
  std::vector<std::vector<std::byte>> unpacked_;
};

class FileGuard final : public SplitGuard {
 public:
  FileGuard(std::shared_ptr<const Reader> reader, const HierarchyView& view, std::span<const std::uint64_t> digests)
      : SplitGuard(view.nodes.size() - 1), reader_(std::move(reader)), view_(view), digests_(digests) {}

 private:
  void check_block(std::size_t block) override {
    const auto [first, end] = range_of_block(view_, block);
    const std::uint32_t star = view_.nodes[first].star, star_end = view_.nodes[end].star;
    if (star > star_end || star_end > view_.stars.size() || digest_of_block(view_, block) != digests_[block])
      refuse(first, end, "are damaged: their checksum is wrong");
    if (const auto problem = check_splits(view_, static_cast<SplitId>(first), static_cast<SplitId>(end)))
      refuse(first, end, "do not form a valid hierarchy: " + *problem);
  }

  [[noreturn]] void refuse(std::size_t first, std::size_t end, const std::string& problem) const {
    reader_->refuse(fmt::format("splits {} to {}", first, end - 1), problem, rebuild);
  }

  std::shared_ptr<const Reader> reader_;
  HierarchyView view_;
  std::span<const std::uint64_t> digests_;
};

MeshReport read_report(Reader& reader) {
  const auto stored = reader.read<StoredReport>(report_name, false);
  if (stored.size() != 1) reader.refuse("", "does not hold one report", rebuild);
  MeshReport report;
  std::memcpy(static_cast<void*>(&report), stored.data(), sizeof(StoredReport));  // all but left_out
  if (!reader.has(left_out_name)) return report;
  const auto left_out = reader.read<LeftOut>(left_out_name, false);
  if (left_out.size() != 1) reader.refuse("", "does not hold one count of what was left out", rebuild);
  report.left_out = left_out[0];
  return report;
}

}  // namespace

OlodFile read_olod(const std::filesystem::path& path, OlodAccess access) {
  const auto reader = std::make_shared<Reader>(path, access);
  HierarchyView view;
  for_each_array(view, [&](std::string_view name, auto& array, bool has_blocks) {
    using T = typename std::decay_t<decltype(array)>::value_type;
    array = reader->template read<T>(name, has_blocks);
  });
  const auto summary = reader->read<Summary>(summary_name, false);
  const MeshReport report = read_report(*reader);
  const auto digests = reader->read<std::uint64_t>(digests_name, false);
  if (summary.size() != 1) reader->refuse("", "does not hold one summary", rebuild);
  view.box = summary[0].box;
  view.input_triangle_count = summary[0].input_triangle_count;
  view.face_count = summary[0].face_count;
  view.error_bound = summary[0].error_bound;
  if (const auto problem = check_base(view))
    reader->refuse("", "does not hold a valid hierarchy: " + *problem, rebuild);
  const auto guard = std::make_shared<FileGuard>(reader, view, digests.subspan(digests.empty() ? 0 : 1));
  if (digests.size() != guard->block_count() + 1)
    reader->refuse("section BLOK", "does not have a checksum for every block", rebuild);
  if (digest_of_base(view) != digests[0]) reader->refuse("base mesh", "is damaged: its checksum is wrong", rebuild);
  return {guarded_hierarchy(view, reader, guard), report,
          reader->is_compressed() ? OlodCompression::zstd : OlodCompression::none};
}

}  // namespace occlod
