#include "hlod/texture/own_images.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <optional>
#include <utility>

#include "base/threads.h"
#include "hlod/store/hlod_data.h"
#include "hlod/texture/image_journal.h"
#include "hlod/tiles/tile_mesh.h"
#include "mesh/section_file.h"

namespace occlod::hlod {
namespace {

// What make_tile_image() needs of a node.
TriangleMesh textured_mesh(const Hlod& hlod, NodeId n) {
  const NodeMesh node = hlod.mesh(n);
  TriangleMesh mesh;
  mesh.positions.assign(node.positions.begin(), node.positions.end());
  mesh.texture_coordinates.assign(node.texture_coordinates.begin(), node.texture_coordinates.end());
  mesh.triangles = tiles::triangles_of(node);
  mesh.materials.resize(hlod.data().materials.size());
  if (!node.materials.empty())
    for (const Triangle& t : mesh.triangles) mesh.triangle_materials.push_back(node.materials[t.x]);
  return mesh;
}

class PartMaker {
 public:
  PartMaker(const Hlod& hlod, const tiles::SourceTextures& sources)
      : hlod_(hlod), sources_(sources), format_(sources.usual_format()) {}

  // Any number of threads may call this.
  [[nodiscard]] ImagePart made(NodeId n) const {
    ImagePart part;
    if (hlod_.node(n).triangles == 0) return part;
    TriangleMesh mesh = textured_mesh(hlod_, n);
    const double mean = tiles::shown_texels(mesh, sources_).mean_size;
    // The lesser of both errors, since tilesets refine by guaranteed ones.
    const Node& node = hlod_.node(n);
    const double error = std::min(node.error, node.guaranteed_error);
    const tiles::TileImage image = make_tile_image(mesh, sources_, texel_size_of(node, error, mean));
    if (image.width == 0) return part;
    part.texel_size = image.texel_size;
    std::vector<glm::u16vec2> coordinates;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      coordinates.push_back(image.is_of_vertex[v] == 0
                                ? glm::u16vec2(0)
                                : glm::u16vec2(glm::round(65535.0 * sources_.place(mesh.texture_coordinates[v]))));
    const std::vector<std::uint8_t> encoded = encode(image, format_);
    part.bytes.resize(coordinates.size() * sizeof(glm::u16vec2) + encoded.size());
    const std::byte* const end = std::copy_n(reinterpret_cast<const std::byte*>(coordinates.data()),
                                             coordinates.size() * sizeof(glm::u16vec2), part.bytes.data());
    std::memcpy(part.bytes.data() + (end - part.bytes.data()), encoded.data(), encoded.size());
    return part;
  }

 private:
  const Hlod& hlod_;
  const tiles::SourceTextures& sources_;
  tiles::TextureFormat format_;
};

}  // namespace

double texel_size_of(const Node& node, double error, double mean) {
  if (node.level == 0) return 0.0;
  double least = mean;
  for (unsigned level = 0; level < node.level; ++level) least *= coarser_by;
  return std::max(error, least);
}

OwnImages make_own_images(const Hlod& hlod, const std::filesystem::path& image_folder,
                          const std::filesystem::path& journal_path, unsigned threads,
                          const std::function<void(double)>& progress) {
  OwnImages images;
  const HlodView& view = hlod.data();
  std::size_t done = 0;
  const std::size_t steps = hlod.node_count() + 2 * std::size_t{view.levels[0].node_count};
  const auto step = [&] {
    if (progress) progress(static_cast<double>(done++) / static_cast<double>(steps));
  };
  const tiles::SourceTextures sources(hlod, image_folder, threads, step);
  if (sources.images().empty()) return images;
  std::optional<ImageJournal> journal;
  if (!journal_path.empty()) journal.emplace(journal_path, hlod, image_folder);
  images.table.resize(hlod.node_count());
  const PartMaker maker(hlod, sources);
  std::vector<ImagePart> parts(std::min<std::size_t>(hlod.node_count(), std::size_t{8} * threads));
  for (NodeId first = 0; first < hlod.node_count(); first += static_cast<NodeId>(parts.size())) {
    const std::size_t count = std::min(parts.size(), hlod.node_count() - first);
    std::size_t taken = 0;
    while (journal && taken < count && journal->take(parts[taken])) ++taken;
    for_each_task(count - taken, threads,
                  [&](std::size_t i) { parts[taken + i] = maker.made(first + static_cast<NodeId>(taken + i)); });
    for (std::size_t i = 0; i < count; ++i) {
      if (journal && i >= taken) journal->append(parts[i]);
      step();
      make_room();
      images.table[first + i] = {images.bytes.size(), sections::checksum_of(parts[i].bytes),
                                 static_cast<std::uint32_t>(parts[i].bytes.size()),
                                 static_cast<float>(parts[i].texel_size)};
      images.bytes.insert(images.bytes.end(), parts[i].bytes.begin(), parts[i].bytes.end());
      images.bytes.resize(align_mesh(images.bytes.size()));
    }
  }
  for (std::size_t m = 0; m < view.materials.size(); ++m)
    images.materials.push_back(sources.image_of(static_cast<MaterialId>(m)) != no_id ? 1 : 0);
  images.nodes.assign(view.nodes.begin(), view.nodes.end());
  for (NodeId n = static_cast<NodeId>(images.nodes.size()); n-- > 0;) {  // children before their parents
    Node& node = images.nodes[n];
    for (const NodeId child : hlod.children(n))
      node.child_error = std::max(node.child_error, images.nodes[child].error);
    node.error = std::max({node.error, node.child_error, images.table[n].texel_size});
  }
  return images;
}

}  // namespace occlod::hlod
