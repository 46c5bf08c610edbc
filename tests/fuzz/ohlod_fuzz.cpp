// HLODs in files. Checksums are put right first: damage by chance is found by them, what is to be found here is what a
// hostile file can do. Whatever the bytes, reading and checking all of it ends with an HLOD that can be walked, or with
// an Error.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "fuzz/memory_file.h"
#include "io/ohlod_format.h"
#include "occlod/core/error.h"
#include "occlod/hlod/validate.h"
#include "occlod/io/ohlod.h"

namespace occlod::ohlod {
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
    sign_meshes();
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

  // The digests of all nodes, if the arrays are such that they have one.
  void sign_meshes() {
    hlod::HlodView view;
    for_each_array(view, [&](std::string_view name, auto& array, bool) {
      array = find<typename std::decay_t<decltype(array)>::value_type>(name);
    });
    const std::span<Summary> summary = find<Summary>(summary_name);
    const std::span<std::uint64_t> digests = find<std::uint64_t>(digests_name);
    if (summary.empty()) return;
    view.box = summary[0].box;
    view.input_triangle_count = summary[0].input_triangle_count;
    view.grouping = static_cast<hlod::Grouping>(summary[0].grouping);
    view.borders = static_cast<hlod::Borders>(summary[0].borders);
    view.has_normals = summary[0].has_normals == 1;
    view.has_colors = summary[0].has_colors == 1;
    if (check_structure(view) || digests.size() != view.nodes.size()) return;
    for (hlod::NodeId n = 0; n < view.nodes.size(); ++n) digests[n] = digest_of_mesh(view, n);
  }

  std::vector<std::byte>& file_;
  std::vector<Section> table_;
};

}  // namespace
}  // namespace occlod::ohlod

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  occlod::ohlod::Signer(bytes).sign();
  const occlod::fuzz::MemoryFile file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  try {
    (void)occlod::hlod::validate(occlod::read_ohlod(file.path()).hlod, {4});
  } catch (const occlod::Error&) {
    return 0;  // refused
  }
  return 0;
}
