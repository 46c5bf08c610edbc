#include <fmt/format.h>

#include <cstddef>
#include <limits>

#include "occlod/core/error.h"
#include "occlod/viewcells/vlod_file.h"
#include "cells/packed_faces.h"
#include "cells/path_cut.h"

namespace occlod {

std::vector<CellObjectMesh> read_cell(const VlodFile& file, CellId cell) {
  if (!file.is_packed() || file.has_objects())
    throw Error({"read_cell()", "", "is for a packed file that was opened without objects",
                 "pack the file with 'occlod cells pack', or give its objects"});
  std::vector<CellId> path;
  file.tree().path_to(cell, path);
  std::vector<CellAdditions> additions;
  std::vector<const CellAdditions*> above;
  additions.reserve(path.size());
  for (const CellId n : path) above.push_back(&additions.emplace_back(file.read(n, above)));

  constexpr std::size_t most = std::numeric_limits<std::size_t>::max();
  vlod::GeometryCache cache(*file.geometry(), {});
  cache.limit(most);
  vlod::PackedFaces faces(cache, most);
  std::vector<CellObjectMesh> meshes(file.objects().size());
  PathCut cut;
  for (std::uint32_t i = 0; i < meshes.size(); ++i) {
    cut.gather(i, above, file.tree().is_leaf(cell));
    const VlodObject& object = file.objects()[i];
    const CellView view(file.tree().node(cell).box, file.options().cell.eyes, object.object_to_world);
    faces.draw(i, cut.applied, cut.hidden, object.two_sided != 0 ? nullptr : &view, fmt::format("cell {}", cell),
               meshes[i]);
  }
  return meshes;
}

}  // namespace occlod
