#include <fmt/format.h>

#include <memory>
#include <string>
#include <type_traits>
#include <utility>

#include "hlod/node_guard.h"
#include "material_sections.h"
#include "occlod/core/error.h"
#include "occlod/hlod/validate.h"
#include "occlod/io/ohlod.h"
#include "ohlod_format.h"

namespace occlod {
namespace {

using namespace ohlod;
using namespace sections;

// By node.
struct Digests {
  std::span<const std::uint64_t> meshes, splits;
};

class FileGuard final : public hlod::NodeGuard {
 public:
  FileGuard(std::shared_ptr<const SectionReader> reader, const hlod::HlodView& view, const Digests& digests)
      : NodeGuard(view.nodes.size(), view.within.size()), reader_(std::move(reader)), view_(view), digests_(digests) {}

 private:
  void check_node(hlod::NodeId n) override {
    if (digest_of_mesh(view_, n) != digests_.meshes[n])
      reader_->refuse(fmt::format("node {}", n), "is damaged: its checksum is wrong");
    if (const auto problem = check_mesh(view_, n))
      reader_->refuse(fmt::format("node {}", n), "has no valid mesh: " + *problem);
  }

  void check_splits(hlod::NodeId n) override {
    if (digest_of_splits(view_, n) != digests_.splits[n])
      reader_->refuse(fmt::format("splits of node {}", n), "are damaged: their checksum is wrong");
    if (const auto problem = hlod::check_within(view_, n))
      reader_->refuse(fmt::format("splits of node {}", n), "are not valid: " + *problem);
  }

  std::shared_ptr<const SectionReader> reader_;
  hlod::HlodView view_;
  Digests digests_;
};

// What an HLOD in a file keeps alive.
struct Owner {
  std::shared_ptr<const SectionReader> reader;
  Materials materials;
};

void take(const Summary& summary, const SectionReader& reader, hlod::HlodView& view) {
  if (summary.has_normals > 1 || summary.has_colors > 1 || summary.wedges > all_wedge_flags)
    reader.refuse("", "does not say whether it has attributes");
  view.box = summary.box;
  view.input_triangle_count = summary.input_triangle_count;
  view.grouping = static_cast<hlod::Grouping>(summary.grouping);
  view.borders = static_cast<hlod::Borders>(summary.borders);
  view.node_triangles = summary.node_triangles;
  view.has_normals = summary.has_normals != 0;
  view.has_colors = summary.has_colors != 0;
  view.has_texture_coordinates = (summary.wedges & has_texture_coordinates) != 0;
  view.has_materials = (summary.wedges & has_materials) != 0;
  view.has_seams = (summary.wedges & has_seams) != 0;
}

}  // namespace

OhlodFile read_ohlod(const std::filesystem::path& path, OlodAccess access) {
  const auto reader = std::make_shared<SectionReader>(path, file_kind, access == OlodAccess::mapped);
  hlod::HlodView view;
  const auto read = [&](std::string_view name, auto& array, bool has_parts) {
    using T = typename std::decay_t<decltype(array)>::value_type;
    array = reader->template read<T>(name, has_parts ? Check::parts : Check::whole);
  };
  for_each_array(view, read);
  take(reader->read_one<Summary>(summary_name, "summary"), *reader, view);
  const auto owner = std::make_shared<const Owner>(Owner{reader, read_materials(*reader)});
  view.materials = owner->materials.materials;
  view.textures = owner->materials.textures;
  view.texture_origin = owner->materials.origin;
  const MeshReport report = reader->read_report();
  Digests digests{reader->read<std::uint64_t>(digests_name), {}};
  if (reader->has(splits_digests_name)) {
    for_each_within_array(view, read);
    digests.splits = reader->read<std::uint64_t>(splits_digests_name);
  }
  if (const auto problem = check_structure(view)) reader->refuse("", "does not hold a valid HLOD: " + *problem);
  if (digests.meshes.size() != view.nodes.size())
    reader->refuse("section BLOK", "does not have a checksum for every node");
  if (digests.splits.size() != view.within.size())
    reader->refuse("section WBLK", "does not have a checksum for every node");
  return {guarded_hlod(view, owner, std::make_shared<FileGuard>(reader, view, digests)), report};
}

}  // namespace occlod
