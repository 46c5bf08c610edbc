#include <vector>

#include "base/large_vector.h"
#include "base/scratch_memory.h"
#include "mesh/material_sections.h"
#include "hlod/store/node_codec.h"
#include "occlod/io/ohlod.h"
#include "hlod/store/ohlod_format.h"

namespace occlod {
namespace {

using namespace ohlod;
using namespace sections;

// What belongs to nodes, and its checksums, node by node.
class NodeSections {
 public:
  NodeSections(SectionWriter& writer, std::string_view digests_name) : writer_(writer), digests_name_(digests_name) {}

  // As it is. `digest_of(n)`: of node n.
  template <typename Digest>
  void add(std::string_view name, std::span<const std::byte> all, std::size_t nodes, const Digest& digest_of) {
    writer_.add(name, all, Check::parts);
    for (hlod::NodeId n = 0; n < nodes; ++n) {
      make_room();
      digests_.push_back(digest_of(n));
    }
    add_digests();
  }

  // `pack(n, bytes)` appends what belongs to node n.
  template <typename Pack>
  void add_packed(std::string_view name, std::string_view places_name, std::size_t nodes, const Pack& pack) {
    for (hlod::NodeId n = 0; n < nodes; ++n) {
      make_room();
      pack(n, packed_);
      digests_.push_back(checksum_of(std::span<const std::byte>(packed_).subspan(places_.back())));
      places_.push_back(packed_.size());
    }
    writer_.add(name, std::span<const std::byte>(packed_), Check::parts);
    writer_.add(places_name, std::span<const std::uint64_t>(places_));
    add_digests();
  }

 private:
  void add_digests() { writer_.add(digests_name_, std::span<const std::uint64_t>(digests_)); }

  SectionWriter& writer_;
  std::string_view digests_name_;
  LargeVector<std::byte> packed_;
  std::vector<std::uint64_t> places_{0}, digests_;
};

Summary summary_of(const hlod::HlodView& view) {
  return {view.box,
          view.input_triangle_count,
          static_cast<std::uint32_t>(view.grouping),
          static_cast<std::uint32_t>(view.borders),
          view.node_triangles,
          view.has_normals ? 1U : 0U,
          view.has_colors ? 1U : 0U,
          wedge_flags(view)};
}

}  // namespace

void write_ohlod(const std::filesystem::path& path, const hlod::Hlod& hlod, const MeshReport& report,
                 OlodCompression compression) {
  hlod.require_all();
  const hlod::HlodView& view = hlod.data();
  const std::size_t nodes = view.nodes.size();
  const bool is_packed = compression == OlodCompression::zstd;
  SectionWriter writer;
  const auto add_tables = [&](std::string_view name, const auto& array, bool has_parts) {
    if (!has_parts) writer.add(name, array);
  };
  NodePacker packer;
  for_each_array(view, add_tables);
  NodeSections meshes(writer, digests_name);
  if (is_packed)
    meshes.add_packed(packed_meshes_name, mesh_places_name, nodes,
                      [&](hlod::NodeId n, auto& to) { packer.pack_mesh(view, n, to); });
  else
    meshes.add(meshes_name, view.meshes, nodes, [&](hlod::NodeId n) { return digest_of_mesh(view, n); });
  const Summary summary = summary_of(view);
  writer.add(summary_name, std::span<const Summary>(&summary, 1));
  if (view.lattice_step > 0.0F) writer.add(lattice_name, std::span<const float>(&view.lattice_step, 1));
  writer.add_report(report);
  NodeSections splits(writer, splits_digests_name);
  if (!view.within.empty()) {
    for_each_within_array(view, add_tables);
    if (is_packed)
      splits.add_packed(packed_splits_name, splits_places_name, nodes,
                        [&](hlod::NodeId n, auto& to) { packer.pack_splits(view, n, to); });
    else
      splits.add(splits_name, view.splits, nodes, [&](hlod::NodeId n) { return digest_of_splits(view, n); });
  }
  MaterialSections materials;
  if (needs_wedges(view)) materials.add(view, writer);
  FileKind kind = file_kind;
  if (!is_packed) kind.version = needs_wedges(view) ? wedges_version : plain_version;
  writer.write(path, kind);
}

}  // namespace occlod
