#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "core/platform.h"
#include "hlod/hlod_data.h"
#include "hlod/mesh_source.h"
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

// For for_each_array(). Arrays with parts: those of meshes and splits.
struct ArrayReader {
  SectionReader& reader;
  bool reads_parts;

  template <typename T>
  void operator()(std::string_view name, std::span<const T>& array, bool has_parts) const {
    if (!has_parts || reads_parts) array = reader.read<T>(name, has_parts ? Check::parts : Check::whole);
  }
};

// All but what is told of splits within nodes.
struct Tables {
  hlod::HlodView view;
  std::shared_ptr<const Owner> owner;  // of what the view refers to
  MeshReport report;
};

// Throws Error.
Tables read_tables(const std::shared_ptr<SectionReader>& reader, bool with_meshes) {
  Tables tables;
  hlod::HlodView& view = tables.view;
  for_each_array(view, ArrayReader{*reader, with_meshes});
  take(reader->read_one<Summary>(summary_name, "summary"), *reader, view);
  tables.owner = std::make_shared<const Owner>(Owner{reader, read_materials(*reader)});
  view.materials = tables.owner->materials.materials;
  view.textures = tables.owner->materials.textures;
  view.texture_origin = tables.owner->materials.origin;
  tables.report = reader->read_report();
  return tables;
}

// Of nodes, without meshes and splits. `mesh_bytes`: of all meshes. Throws Error.
std::span<const std::uint64_t> check_nodes(SectionReader& reader, const hlod::HlodView& view,
                                           std::uint64_t mesh_bytes) {
  if (const auto problem = check_structure(view, mesh_bytes))
    reader.refuse("", "does not hold a valid HLOD: " + *problem);
  const auto digests = reader.read<std::uint64_t>(digests_name);
  if (digests.size() != view.nodes.size()) reader.refuse("section BLOK", "does not have a checksum for every node");
  return digests;
}

// Meshes in an open file.
class FileMeshes final : public hlod::MeshSource {
 public:
  FileMeshes(std::shared_ptr<const InputFile> file, std::shared_ptr<const SectionReader> reader,
             const hlod::HlodView& view, std::span<const std::uint64_t> digests)
      : file_(std::move(file)),
        reader_(std::move(reader)),
        view_(view),
        digests_(digests),
        place_(reader_->offset_of(meshes_name)),
        bytes_(reader_->bytes_of(meshes_name)) {}

  [[nodiscard]] std::size_t bytes_of(hlod::NodeId n) const noexcept override {
    const hlod::Node& node = view_.nodes[n];
    const std::uint64_t bytes = hlod::align_mesh(hlod::MeshLayout(node, arrays_of(view_)).bytes);
    return std::min(bytes, bytes_ - node.mesh);
  }

  void read(hlod::NodeId first, std::span<const std::span<std::byte>> meshes) override {
    try {
      file_->read(meshes, place_ + view_.nodes[first].mesh);
    } catch (const std::system_error& error) {
      reader_->refuse(fmt::format("node {}", first), fmt::format("cannot be read: {}", error.code().message()),
                      "check that the file is whole");
    }
  }

  void check(hlod::NodeId n, std::span<const std::byte> mesh) const override {
    if (checksum_of(mesh) != digests_[n])
      reader_->refuse(fmt::format("node {}", n), "is damaged: its checksum is wrong");
    if (const auto problem = check_mesh(view_, n, mesh_at(view_, n, mesh.data())))
      reader_->refuse(fmt::format("node {}", n), "has no valid mesh: " + *problem);
  }

 private:
  std::shared_ptr<const InputFile> file_;
  std::shared_ptr<const SectionReader> reader_;
  hlod::HlodView view_;
  std::span<const std::uint64_t> digests_;
  std::uint64_t place_, bytes_;  // of all meshes
};

}  // namespace

OhlodFile read_ohlod(const std::filesystem::path& path, OlodAccess access) {
  const auto reader = std::make_shared<SectionReader>(path, file_kind, access == OlodAccess::mapped);
  auto [view, owner, report] = read_tables(reader, true);
  Digests digests;
  if (reader->has(splits_digests_name)) {
    for_each_within_array(view, ArrayReader{*reader, true});
    digests.splits = reader->read<std::uint64_t>(splits_digests_name);
  }
  digests.meshes = check_nodes(*reader, view, view.meshes.size());
  if (digests.splits.size() != view.within.size())
    reader->refuse("section WBLK", "does not have a checksum for every node");
  return {guarded_hlod(view, owner, std::make_shared<FileGuard>(reader, view, digests)), report};
}

OhlodFile open_ohlod(const std::filesystem::path& path, const hlod::CacheOptions& cache) {
  const auto file = open_file(path);
  const auto reader = std::make_shared<SectionReader>(file, path, file_kind);
  const auto [view, owner, report] = read_tables(reader, false);
  const auto digests = check_nodes(*reader, view, reader->bytes_of(meshes_name));
  auto source = std::make_unique<FileMeshes>(file, reader, view, digests);
  return {paged_hlod(std::make_shared<hlod::NodeStore>(view, owner, std::move(source), cache)), report};
}

}  // namespace occlod
