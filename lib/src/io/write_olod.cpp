#include <algorithm>
#include <cstring>
#include <type_traits>
#include <vector>

#include "io/atomic_file.h"
#include "occlod/io/olod.h"
#include "olod_codec.h"
#include "olod_format.h"

namespace occlod {
namespace {

using namespace olod;

std::uint64_t align_up(std::uint64_t offset) { return (offset + alignment - 1) / alignment * alignment; }

class Writer {
 public:
  explicit Writer(OlodCompression compression) : compression_(compression) {}

  template <typename T>
  void add(std::string_view name, std::span<const T> values, bool has_blocks) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::span<const std::byte> bytes = std::as_bytes(values);
    Section section;
    std::copy_n(name.begin(), section.name.size(), section.name.begin());
    section.element_bytes = sizeof(T);
    section.bytes = section.raw_bytes = bytes.size();
    if (!has_blocks) section.checksum = checksum_of(bytes);
    contents_.push_back(bytes);
    packed_.emplace_back();
    if (has_blocks && compression_ == OlodCompression::zstd && !bytes.empty()) {
      packed_.back() = pack(bytes, sizeof(T));
      contents_.back() = packed_.back();
      section.bytes = packed_.back().size();
      section.codec = Codec::zstd;
    }
    table_.push_back(section);
  }

  void write(const std::filesystem::path& path) {
    std::uint64_t offset = sizeof(FileHeader) + table_.size() * sizeof(Section);
    for (Section& section : table_) {
      section.offset = align_up(offset);
      offset = section.offset + section.bytes;
    }
    const auto table = std::as_bytes(std::span(table_));
    const FileHeader header{magic, olod_version, static_cast<std::uint32_t>(table_.size()), offset, checksum_of(table)};
    AtomicFile file(path);
    std::uint64_t written = 0;
    const auto put = [&](std::span<const std::byte> bytes) {
      file.write(bytes);
      written += bytes.size();
    };
    put(std::as_bytes(std::span(&header, 1)));
    put(table);
    constexpr std::array<std::byte, alignment> padding{};
    for (std::size_t i = 0; i < table_.size(); ++i) {
      put(std::span(padding).first(table_[i].offset - written));
      put(contents_[i]);
    }
    file.commit();
  }

 private:
  OlodCompression compression_;
  std::vector<Section> table_;
  std::vector<std::span<const std::byte>> contents_;
  std::vector<std::vector<std::byte>> packed_;
};

// That of the base mesh, then those of the blocks.
std::vector<std::uint64_t> digests_of(const HierarchyView& view) {
  std::vector<std::uint64_t> digests{digest_of_base(view)};
  for (std::size_t block = 0; range_of_block(view, block).first < view.nodes.size() - 1; ++block)
    digests.push_back(digest_of_block(view, block));
  return digests;
}

}  // namespace

void write_olod(const std::filesystem::path& path, const Hierarchy& hierarchy, const MeshReport& report,
                OlodCompression compression) {
  hierarchy.require_all();
  const HierarchyView& view = hierarchy.data();
  Writer writer(compression);
  for_each_array(
      view, [&](std::string_view name, const auto& array, bool has_blocks) { writer.add(name, array, has_blocks); });
  const Summary summary{view.box, view.input_triangle_count, view.face_count, view.error_bound, 0};
  const std::vector<std::uint64_t> digests = digests_of(view);
  writer.add(digests_name, std::span<const std::uint64_t>(digests), false);
  writer.add(summary_name, std::span<const Summary>(&summary, 1), false);
  StoredReport stored;
  std::memcpy(stored.data(), &report, sizeof(stored));
  writer.add(report_name, std::span<const StoredReport>(&stored, 1), false);
  if (report.left_out != LeftOut{}) writer.add(left_out_name, std::span<const LeftOut>(&report.left_out, 1), false);
  writer.write(path);
}

}  // namespace occlod
