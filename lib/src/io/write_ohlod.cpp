#include <vector>

#include "occlod/io/ohlod.h"
#include "ohlod_format.h"

namespace occlod {

using namespace ohlod;
using namespace sections;

void write_ohlod(const std::filesystem::path& path, const hlod::Hlod& hlod, const MeshReport& report) {
  hlod.require_all();
  const hlod::HlodView& view = hlod.data();
  SectionWriter writer;
  for_each_array(view, [&](std::string_view name, const auto& array, bool has_parts) {
    writer.add(name, array, has_parts ? Check::parts : Check::whole);
  });
  std::vector<std::uint64_t> digests;
  for (hlod::NodeId n = 0; n < view.nodes.size(); ++n) digests.push_back(digest_of_mesh(view, n));
  const Summary summary{view.box,
                        view.input_triangle_count,
                        static_cast<std::uint32_t>(view.grouping),
                        static_cast<std::uint32_t>(view.borders),
                        view.node_triangles,
                        view.has_normals ? 1U : 0U,
                        view.has_colors ? 1U : 0U,
                        0};
  writer.add(digests_name, std::span<const std::uint64_t>(digests));
  writer.add(summary_name, std::span<const Summary>(&summary, 1));
  writer.add_report(report);
  writer.write(path, file_kind);
}

}  // namespace occlod
