// The refined mesh on the screen.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "lines.h"
#include "mesh_buffers.h"
#include "mesh_program.h"
#include "refine_worker.h"
#include "render_target.h"

namespace occlod::viewer {

class SceneDrawing {
 public:
  explicit SceneDrawing(const gl::Functions& gl);

  // Brings the buffers up to date with a frame; null draws nothing. Does nothing for the frame that it has already.
  void upload(std::shared_ptr<const RefinedFrame> frame);

  enum class Colors { as_looked_at, seen };
  // Draws side `side` of the frame (the first where it has fewer) over the background, then lines.
  void draw(RenderTarget& target, const Camera& camera, std::size_t side, const LookSettings& look,
            const std::vector<Line>& lines, Colors colors = Colors::as_looked_at);

 private:
  struct Drawn {
    explicit Drawn(const gl::Functions& gl) : triangles(gl), colors(gl), seen(gl) {}
    TriangleBuffers triangles;
    TriangleColors colors;
    TriangleColors seen;
  };
  using Side = std::vector<Drawn>;  // for each object, in the frame's order
  void draw_object(const PlacedObject& object, const TriangleBuffers& triangles, const TriangleColors& colors,
                   const View& view, const LookSettings& look) const;

  const gl::Functions* gl_;
  MeshProgram plain_;
  MeshProgram wire_;
  BackgroundProgram background_;
  LineDrawing lines_;
  std::shared_ptr<const RefinedFrame> frame_;
  std::map<std::shared_ptr<const ViewMesh>, VertexBuffers> vertices_;
  std::vector<Side> sides_;
};

}  // namespace occlod::viewer
