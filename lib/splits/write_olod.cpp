#include <vector>

#include "mesh/material_sections.h"
#include "occlod/io/olod.h"
#include "splits/olod_format.h"

namespace occlod {
namespace {

using namespace olod;
using namespace sections;

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
  const Codec codec = compression == OlodCompression::zstd ? Codec::zstd : Codec::stored;
  SectionWriter writer;
  for_each_array(view, [&](std::string_view name, const auto& array, bool has_blocks) {
    writer.add(name, array, has_blocks ? Check::parts : Check::whole, has_blocks ? codec : Codec::stored);
  });
  MaterialSections materials;
  FileKind kind = file_kind;
  if (needs_wedges(view)) {
    for_each_wedge_array(view, [&](std::string_view name, const auto& array, bool has_blocks) {
      if (!array.empty())
        writer.add(name, array, has_blocks ? Check::parts : Check::whole, has_blocks ? codec : Codec::stored);
    });
    materials.add(view, writer);
  } else {
    kind.version = plain_version;
  }
  const Summary summary{view.box, view.input_triangle_count, view.face_count, view.error_bound, 0};
  const std::vector<std::uint64_t> digests = digests_of(view);
  writer.add(digests_name, std::span<const std::uint64_t>(digests));
  writer.add(summary_name, std::span<const Summary>(&summary, 1));
  writer.add_report(report);
  writer.write(path, kind);
}

}  // namespace occlod
