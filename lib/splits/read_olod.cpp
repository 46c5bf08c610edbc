#include <fmt/format.h>

#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "splits/split_guard.h"
#include "splits/structure.h"
#include "mesh/material_sections.h"
#include "occlod/core/error.h"
#include "occlod/io/olod.h"
#include "splits/olod_format.h"

namespace occlod {
namespace {

using namespace olod;
using namespace sections;

class FileGuard final : public SplitGuard {
 public:
  FileGuard(std::shared_ptr<const SectionReader> reader, const HierarchyView& view,
            std::span<const std::uint64_t> digests)
      : SplitGuard(view.nodes.size() - 1), reader_(std::move(reader)), view_(view), digests_(digests) {}

 private:
  void check_block(std::size_t block) override {
    const auto [first, end] = range_of_block(view_, block);
    const std::uint32_t star = view_.nodes[first].star, star_end = view_.nodes[end].star;
    if (star > star_end || star_end > view_.stars.size() || !has_corners_in_place(first, end) ||
        digest_of_block(view_, block) != digests_[block])
      refuse(first, end, "are damaged: their checksum is wrong");
    if (const auto problem = check_splits(view_, static_cast<SplitId>(first), static_cast<SplitId>(end)))
      refuse(first, end, "do not form a valid hierarchy: " + *problem);
  }

  [[nodiscard]] bool has_corners_in_place(std::size_t first, std::size_t end) const {
    if (view_.corner_starts.empty()) return true;
    return view_.corner_starts[first] <= view_.corner_starts[end] && view_.corner_starts[end] <= view_.corners.size();
  }

  [[noreturn]] void refuse(std::size_t first, std::size_t end, const std::string& problem) const {
    reader_->refuse(fmt::format("splits {} to {}", first, end - 1), problem);
  }

  std::shared_ptr<const SectionReader> reader_;
  HierarchyView view_;
  std::span<const std::uint64_t> digests_;
};

// What a hierarchy in a file keeps alive.
struct Owner {
  std::shared_ptr<const SectionReader> reader;
  Materials materials;
};

}  // namespace

OlodFile read_olod(const std::filesystem::path& path, OlodAccess access) {
  const auto reader = std::make_shared<SectionReader>(path, file_kind, access == OlodAccess::mapped);
  HierarchyView view;
  for_each_array(view, [&](std::string_view name, auto& array, bool has_blocks) {
    using T = typename std::decay_t<decltype(array)>::value_type;
    array = reader->template read<T>(name, has_blocks ? Check::parts : Check::whole);
  });
  for_each_wedge_array(view, [&](std::string_view name, auto& array, bool has_blocks) {
    using T = typename std::decay_t<decltype(array)>::value_type;
    if (reader->has(name)) array = reader->template read<T>(name, has_blocks ? Check::parts : Check::whole);
  });
  const auto owner = std::make_shared<const Owner>(Owner{reader, read_materials(*reader)});
  view.materials = owner->materials.materials;
  view.textures = owner->materials.textures;
  view.texture_origin = owner->materials.origin;
  const auto summary = reader->read_one<Summary>(summary_name, "summary");
  const MeshReport report = reader->read_report();
  const auto digests = reader->read<std::uint64_t>(digests_name);
  view.box = summary.box;
  view.input_triangle_count = summary.input_triangle_count;
  view.face_count = summary.face_count;
  view.error_bound = summary.error_bound;
  if (const auto problem = check_base(view)) reader->refuse("", "does not hold a valid hierarchy: " + *problem);
  const auto guard = std::make_shared<FileGuard>(reader, view, digests.subspan(digests.empty() ? 0 : 1));
  if (digests.size() != guard->block_count() + 1)
    reader->refuse("section BLOK", "does not have a checksum for every block");
  if (digest_of_base(view) != digests[0]) reader->refuse("base mesh", "is damaged: its checksum is wrong");
  return {guarded_hierarchy(view, owner, guard), report,
          reader->is_compressed() ? OlodCompression::zstd : OlodCompression::none};
}

}  // namespace occlod
