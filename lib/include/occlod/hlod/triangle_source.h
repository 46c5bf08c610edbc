// Triangles that are too many for a TriangleMesh, piece by piece.
#pragma once

#include <functional>

#include "occlod/mesh/triangle_mesh.h"

namespace occlod::hlod {

// Takes pieces of a mesh.
class TriangleSink {
 public:
  virtual ~TriangleSink() = default;
  // A piece: any triangle soup, with ids into its own positions. Normals and colours are kept when every piece has
  // them, texture coordinates when any has: the others lie at (0, 0). Each piece has the materials and textures of
  // those before it, perhaps with more behind them, or none. Throws Error as clean() does.
  virtual void add(const TriangleMesh& piece) = 0;
};

// Gives all its triangles to a sink, in pieces of a size that fits into memory, some hundred thousand triangles each.
// Called once or several times; gives the same each time.
using TriangleSource = std::function<void(TriangleSink& sink)>;

}  // namespace occlod::hlod
