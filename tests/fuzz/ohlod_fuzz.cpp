// HLODs in files. Checksums are put right first: damage by chance is found by them, what is to be found here is what a
// hostile file can do. Whatever the bytes, reading and checking all of it ends with an HLOD that can be walked, or with
// an Error.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "fuzz/memory_file.h"
#include "fuzz/section_signer.h"
#include "io/ohlod_format.h"
#include "occlod/core/error.h"
#include "occlod/hlod/validate.h"
#include "occlod/hlod/within.h"
#include "occlod/io/ohlod.h"

namespace occlod::ohlod {
namespace {

// The digests of all nodes, if the arrays are such that they have one.
void sign_meshes(const fuzz::SectionSigner& file) {
  hlod::HlodView view;
  const auto find = [&](std::string_view name, auto& array, bool) {
    array = file.find<typename std::decay_t<decltype(array)>::value_type>(name);
  };
  for_each_array(view, find);
  for_each_within_array(view, find);
  const std::span<Summary> summary = file.find<Summary>(summary_name);
  const std::span<std::uint64_t> digests = file.find<std::uint64_t>(digests_name);
  const std::span<std::uint64_t> splits_digests = file.find<std::uint64_t>(splits_digests_name);
  if (summary.empty()) return;
  view.box = summary[0].box;
  view.input_triangle_count = summary[0].input_triangle_count;
  view.grouping = static_cast<hlod::Grouping>(summary[0].grouping);
  view.borders = static_cast<hlod::Borders>(summary[0].borders);
  view.has_normals = summary[0].has_normals == 1;
  view.has_colors = summary[0].has_colors == 1;
  if (check_structure(view) || digests.size() != view.nodes.size()) return;
  for (hlod::NodeId n = 0; n < view.nodes.size(); ++n) digests[n] = digest_of_mesh(view, n);
  if (splits_digests.size() != view.within.size()) return;
  for (hlod::NodeId n = 0; n < view.within.size(); ++n) splits_digests[n] = digest_of_splits(view, n);
}

void sign(std::vector<std::byte>& bytes) {
  fuzz::SectionSigner file(bytes, file_kind);
  file.sign([&] { sign_meshes(file); });
}

}  // namespace
}  // namespace occlod::ohlod

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  occlod::ohlod::sign(bytes);
  const occlod::fuzz::MemoryFile file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  try {
    const occlod::hlod::Hlod hlod = occlod::read_ohlod(file.path()).hlod;
    (void)occlod::hlod::validate(hlod, {4});
    for (occlod::hlod::NodeId n = 0; n < hlod.node_count(); ++n)
      (void)occlod::hlod::within_cut(hlod, n, 0.5 * static_cast<double>(hlod.node(n).error));
  } catch (const occlod::Error&) {
    return 0;  // refused
  }
  return 0;
}
