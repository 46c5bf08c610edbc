// Hierarchies in files. Checksums are put right first: damage by chance is found by them, what is to be found here is
// what a hostile file can do. Whatever the bytes, reading and checking all of it ends with a hierarchy that can be
// walked, or with an Error.
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "fuzz/memory_file.h"
#include "fuzz/section_signer.h"
#include "mesh/materials.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "splits/hierarchy_data.h"
#include "splits/olod.h"
#include "splits/structure.h"

namespace occlod::olod {
namespace {

bool have_corners_in_place(const HierarchyView& view, std::size_t first, std::size_t end) {
  if (view.corner_starts.empty()) return true;
  return view.corner_starts[first] <= view.corner_starts[end] && view.corner_starts[end] <= view.corners.size();
}

// The digests of all blocks, as far as the arrays are such that they have one.
void sign_blocks(const fuzz::SectionSigner& file) {
  HierarchyView view;
  const auto find = [&](std::string_view name, auto& array, bool) {
    array = file.find<typename std::decay_t<decltype(array)>::value_type>(name);
  };
  for_each_array(view, find);
  for_each_wedge_array(view, find);
  // Whether wedges have materials that are there, the reader finds out: there may be as many as can be.
  static const std::vector<Material> any_materials(max_materials);
  view.materials = any_materials;
  if (const auto summary = file.find<Summary>(summary_name); !summary.empty()) {
    view.input_triangle_count = summary[0].input_triangle_count;
    view.face_count = summary[0].face_count;
  }
  const std::span<std::uint64_t> digests = file.find<std::uint64_t>(digests_name);
  if (digests.empty() || view.nodes.empty() || check_base(view)) return;
  digests[0] = digest_of_base(view);
  for (std::size_t block = 0; block + 1 < digests.size(); ++block) {
    if (block * SplitGuard::block_size + 1 >= view.nodes.size()) return;
    const auto [first, end] = range_of_block(view, block);
    const std::uint32_t star = view.nodes[first].star, star_end = view.nodes[end].star;
    if (star <= star_end && star_end <= view.stars.size() && have_corners_in_place(view, first, end))
      digests[block + 1] = digest_of_block(view, block);
  }
}

void read_all(const std::filesystem::path& path) {
  const Hierarchy hierarchy = read_olod(path).hierarchy;
  hierarchy.require_all();
  (void)validate(hierarchy, 2);
  for (const std::size_t triangles : {std::size_t{0}, hierarchy.input_triangle_count() / 2})
    (void)cut_mesh(hierarchy, cut_to_triangles(hierarchy, triangles));
}

void sign(std::vector<std::byte>& bytes) {
  fuzz::SectionSigner file(bytes, file_kind);
  file.sign([&] { sign_blocks(file); });
}

}  // namespace
}  // namespace occlod::olod

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<std::byte> bytes(size);
  if (size > 0) std::memcpy(bytes.data(), data, size);
  occlod::olod::sign(bytes);
  const occlod::fuzz::MemoryFile file(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  try {
    occlod::olod::read_all(file.path());
  } catch (const occlod::Error&) {
    return 0;  // refused
  }
  return 0;
}
