// Hierarchies in files. Checksums are put right first: damage by chance is found by them, what is to be found here is
// what a hostile file can do. Whatever the bytes, reading and checking all of it ends with a hierarchy that can be
// walked, or with an Error.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "fuzz/memory_file.h"
#include "hierarchy/split_guard.h"
#include "hierarchy/structure.h"
#include "io/olod_format.h"
#include "occlod/core/error.h"
#include "occlod/hierarchy/cut_mesh.h"
#include "occlod/hierarchy/validate.h"
#include "occlod/io/olod.h"

namespace occlod::olod {
namespace {

using namespace sections;

class Signer {
 public:
  explicit Signer(std::vector<std::byte>& file) : file_(file) {}

  void sign() {
    FileHeader header;
    if (file_.size() < sizeof(header)) return;
    std::memcpy(&header, file_.data(), sizeof(header));
    header.magic = file_kind.magic;
    header.version = file_kind.version;
    header.file_bytes = file_.size();
    const std::size_t room = (file_.size() - sizeof(header)) / sizeof(Section);
    table_.resize(std::min<std::size_t>({header.section_count, room, most_sections}));
    const auto table = std::as_writable_bytes(std::span(table_));
    if (table_.empty()) return;
    std::memcpy(table.data(), file_.data() + sizeof(header), table.size());
    sign_blocks();
    for (Section& section : table_)
      if (section.checksum != 0) section.checksum = checksum_of(bytes_of(section));
    header.table_checksum = checksum_of(table);
    std::memcpy(file_.data() + sizeof(header), table.data(), table.size());
    std::memcpy(file_.data(), &header, sizeof(header));
  }

 private:
  // Nothing where they lie outside the file or are packed.
  [[nodiscard]] std::span<std::byte> bytes_of(const Section& section) const {
    if (section.codec != Codec::stored || section.offset > file_.size() ||
        section.bytes > file_.size() - section.offset)
      return {};
    return std::span(file_).subspan(section.offset, section.bytes);
  }

  template <typename T>
  [[nodiscard]] std::span<T> find(std::string_view name) const {
    for (const Section& section : table_) {
      if (std::string_view(section.name.data(), section.name.size()) != name) continue;
      const std::span<std::byte> bytes = bytes_of(section);
      if (section.offset % alignment != 0) return {};
      return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
    }
    return {};
  }

  // The digests of all blocks, as far as the arrays are such that they have one.
  void sign_blocks() {
    HierarchyView view;
    for_each_array(view, [&](std::string_view name, auto& array, bool) {
      array = find<typename std::decay_t<decltype(array)>::value_type>(name);
    });
    const std::span<std::uint64_t> digests = find<std::uint64_t>(digests_name);
    if (digests.empty() || view.nodes.empty() || check_base(view)) return;
    digests[0] = digest_of_base(view);
    for (std::size_t block = 0; block + 1 < digests.size(); ++block) {
      if (block * SplitGuard::block_size + 1 >= view.nodes.size()) return;
      const auto [first, end] = range_of_block(view, block);
      const std::uint32_t star = view.nodes[first].star, star_end = view.nodes[end].star;
      if (star <= star_end && star_end <= view.stars.size()) digests[block + 1] = digest_of_block(view, block);
    }
  }

  std::vector<std::byte>& file_;
  std::vector<Section> table_;
};

void read_all(const std::filesystem::path& path) {
  const Hierarchy hierarchy = read_olod(path).hierarchy;
  hierarchy.require_all();
  (void)validate(hierarchy, {2});
  for (const std::size_t triangles : {std::size_t{0}, hierarchy.input_triangle_count() / 2})
    (void)cut_mesh(hierarchy, cut_to_triangles(hierarchy, triangles));
}

}  // namespace
}  // namespace occlod::olod

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  occlod::olod::Signer(bytes).sign();
  const occlod::fuzz::MemoryFile file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  try {
    occlod::olod::read_all(file.path());
  } catch (const occlod::Error&) {
    return 0;  // refused
  }
  return 0;
}
