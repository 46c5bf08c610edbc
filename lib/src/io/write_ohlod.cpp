#include <vector>

#include "core/scratch_memory.h"
#include "material_sections.h"
#include "occlod/io/ohlod.h"
#include "ohlod_format.h"

namespace occlod {

using namespace ohlod;
using namespace sections;

void write_ohlod(const std::filesystem::path& path, const hlod::Hlod& hlod, const MeshReport& report) {
  hlod.require_all();
  const hlod::HlodView& view = hlod.data();
  SectionWriter writer;
  const auto add = [&](std::string_view name, const auto& array, bool has_parts) {
    writer.add(name, array, has_parts ? Check::parts : Check::whole);
  };
  for_each_array(view, add);
  std::vector<std::uint64_t> digests, splits_digests;
  for (hlod::NodeId n = 0; n < view.nodes.size(); ++n) {
    make_room();
    digests.push_back(digest_of_mesh(view, n));
  }
  const Summary summary{view.box,
                        view.input_triangle_count,
                        static_cast<std::uint32_t>(view.grouping),
                        static_cast<std::uint32_t>(view.borders),
                        view.node_triangles,
                        view.has_normals ? 1U : 0U,
                        view.has_colors ? 1U : 0U,
                        wedge_flags(view)};
  writer.add(digests_name, std::span<const std::uint64_t>(digests));
  writer.add(summary_name, std::span<const Summary>(&summary, 1));
  writer.add_report(report);
  if (!view.within.empty()) {
    for (hlod::NodeId n = 0; n < view.nodes.size(); ++n) splits_digests.push_back(digest_of_splits(view, n));
    for_each_within_array(view, add);
    writer.add(splits_digests_name, std::span<const std::uint64_t>(splits_digests));
  }
  MaterialSections materials;
  FileKind kind = file_kind;
  if (needs_wedges(view))
    materials.add(view, writer);
  else
    kind.version = plain_version;
  writer.write(path, kind);
}

}  // namespace occlod
