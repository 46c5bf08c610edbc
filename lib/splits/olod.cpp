#include "splits/olod.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "mesh/section_file.h"
#include "occlod/base.h"
#include "occlod/build_hierarchy.h"
#include "splits/hierarchy_data.h"
#include "splits/structure.h"

namespace occlod::olod {
namespace {

class Digest {
 public:
  Digest() { XXH3_64bits_reset(&state_); }
  template <typename T>
  void add(std::span<const T> values) {
    XXH3_64bits_update(&state_, values.data(), values.size_bytes());
  }
  // Adds a range of an array to the digest, as far as it is there: attribute arrays may be empty, and arrays of a
  // hierarchy that nobody has checked too short.
  template <typename T>
  void add(std::span<const T> values, std::size_t first, std::size_t count) {
    if (first < values.size()) add(values.subspan(first, std::min(count, values.size() - first)));
  }
  [[nodiscard]] std::uint64_t value() const { return XXH3_64bits_digest(&state_); }

 private:
  XXH3_state_t state_;
};

void add_wedges(const HierarchyView& view, std::size_t first, std::size_t count, Digest& digest) {
  digest.add(view.positions, first, count);
  digest.add(view.normals, first, count);
  digest.add(view.colors, first, count);
  digest.add(view.texture_coordinates, first, count);
  digest.add(view.wedge_materials, first, count);
}

std::size_t split_count(const HierarchyView& view) { return view.nodes.size() - 1; }

// Adds vertices and their extra wedges, which are sorted by vertex.
void add_vertices(const HierarchyView& view, std::size_t first, std::size_t count, Digest& digest) {
  add_wedges(view, first, count, digest);
  const WedgeRange extra = extra_wedges_of(view, first, count);
  if (extra.count > 0) add_wedges(view, extra.first, extra.count, digest);
}

}  // namespace

bool has_looks(const HierarchyView& view) {
  return !view.extra_wedges.empty() || !view.texture_coordinates.empty() || !view.wedge_materials.empty() ||
         !view.materials.empty() || !view.textures.empty();
}

bool needs_wedges(const HierarchyView& view) { return has_looks(view) || !view.attribute_errors.empty(); }

std::uint64_t digest_of_base(const HierarchyView& view) {
  Digest digest;
  add_vertices(view, 0, vertex_count(view) - split_count(view), digest);
  return digest.value();
}

BlockRange range_of_block(const HierarchyView& view, std::size_t block) {
  const std::size_t first = block * SplitGuard::block_size;
  return {first, std::min(first + SplitGuard::block_size, split_count(view))};
}

std::uint64_t digest_of_block(const HierarchyView& view, std::size_t block) {
  const auto [first, end] = range_of_block(view, block);
  Digest digest;
  digest.add(view.nodes, first, end - first);
  const std::size_t star = view.nodes[first].star;
  digest.add(view.stars, star, view.nodes[end].star - star);
  if (!view.corner_starts.empty()) {
    digest.add(view.corner_starts, first, end + 1 - first);
    const std::size_t corner = view.corner_starts[first];
    digest.add(view.corners, corner, view.corner_starts[end] - corner);
  }
  digest.add(view.attribute_errors, first, end - first);
  add_vertices(view, vertex_count(view) - split_count(view) + first, end - first, digest);
  return digest.value();
}

}  // namespace occlod::olod

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

// Keeps alive what a hierarchy in a file refers to.
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
  view.origin = reader->read_origin();
  view.up = owner->materials.up;
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
          reader->is_compressed() ? OlodCompression::zstd : OlodCompression::none, reader->header().version};
}

namespace {

using namespace olod;
using namespace sections;

// Returns the digest of the base mesh, then those of the blocks.
std::vector<std::uint64_t> digests_of(const HierarchyView& view) {
  std::vector<std::uint64_t> digests{digest_of_base(view)};
  for (std::size_t block = 0; range_of_block(view, block).first < view.nodes.size() - 1; ++block)
    digests.push_back(digest_of_block(view, block));
  return digests;
}

}  // namespace

void write_olod(const std::filesystem::path& path, const Hierarchy& hierarchy, const MeshReport& report,
                OlodCompression compression, const std::filesystem::path& image_folder) {
  hierarchy.require_all();
  const HierarchyView& view = hierarchy.data();
  const Codec codec = compression == OlodCompression::zstd ? Codec::zstd : Codec::stored;
  SectionWriter writer;
  for_each_array(view, [&](std::string_view name, const auto& array, bool has_blocks) {
    writer.add(name, array, has_blocks ? Check::parts : Check::whole, has_blocks ? codec : Codec::stored);
  });
  MaterialSections materials;
  FileKind kind = file_kind;
  kind.version = needs_wedges(view) ? wedges_version : plain_version;
  if (needs_wedges(view)) {
    for_each_wedge_array(view, [&](std::string_view name, const auto& array, bool has_blocks) {
      if (!array.empty())
        writer.add(name, array, has_blocks ? Check::parts : Check::whole, has_blocks ? codec : Codec::stored);
    });
  }
  if (has_looks(view) || view.up != UpAxis::z) materials.add(view, writer, {image_folder, folder_of(path)});
  if (writer.add_origin(view.origin)) kind.version = olod_version;
  const Summary summary{view.box, view.input_triangle_count, view.face_count, view.error_bound, 0};
  const std::vector<std::uint64_t> digests = digests_of(view);
  writer.add(digests_name, std::span<const std::uint64_t>(digests));
  writer.add(summary_name, std::span<const Summary>(&summary, 1));
  writer.add_report(report);
  writer.write(path, kind);
}

}  // namespace occlod
