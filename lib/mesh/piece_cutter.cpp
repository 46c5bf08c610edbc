#include "mesh/piece_cutter.h"

#include "base/scratch_memory.h"

namespace occlod {

TriangleMesh PieceCutter::cut(std::size_t begin, std::size_t end) {
  constexpr std::size_t triangles_between_looks = 1024;  // whether memory has room
  TriangleMesh piece;
  wedges_.clear();
  for (std::size_t t = begin; t < end; ++t) {
    if (t % triangles_between_looks == 0) make_room();
    Triangle triangle = mesh_.triangles[t];
    for (int k = 0; k < 3; ++k) {
      VertexId& local = local_[triangle[k]];
      if (local == no_id) {
        local = static_cast<VertexId>(wedges_.size());
        wedges_.push_back(triangle[k]);
      }
      triangle[k] = local;
    }
    piece.triangles.push_back(triangle);
    if (!mesh_.triangle_materials.empty()) piece.triangle_materials.push_back(mesh_.triangle_materials[t]);
  }
  const auto gather = [&](const auto& from, auto& to) {
    if (from.empty()) return;
    for (const WedgeId wedge : wedges_) {
      if (to.size() % triangles_between_looks == 0) make_room();
      to.push_back(from[wedge]);
    }
  };
  gather(mesh_.positions, piece.positions);
  gather(mesh_.normals, piece.normals);
  gather(mesh_.colors, piece.colors);
  gather(mesh_.texture_coordinates, piece.texture_coordinates);
  piece.texture_origin = mesh_.texture_origin;
  for (const WedgeId wedge : wedges_) local_[wedge] = no_id;
  return piece;
}

}  // namespace occlod
