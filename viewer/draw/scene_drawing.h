// Draws the refined mesh on the screen.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "clipping.h"
#include "layer_buffer.h"
#include "lines.h"
#include "mesh_buffers.h"
#include "mesh_program.h"
#include "refine_worker.h"
#include "render_target.h"

namespace occlod::viewer {

class SceneDrawing {
 public:
  explicit SceneDrawing(const gl::Functions& gl);

  // Updates the buffers for a frame; null draws nothing. Does nothing for the frame that it already has, and uploads
  // only the changes for one that follows it. Returns how many bytes it uploads of what is not static.
  std::size_t upload(std::shared_ptr<const RefinedFrame> frame);

  // Meshes are drawn on one side of this plane from now on; lines everywhere.
  void set_clip_plane(const ClipPlane& plane) { clip_plane_ = plane; }

  enum class Colors { as_looked_at, seen };
  // Draws side `side` of the frame (the first if it has fewer) over the background, then lines.
  void draw(RenderTarget& target, const Camera& camera, std::size_t side, const LookSettings& look,
            const std::vector<Line>& lines, Colors colors = Colors::as_looked_at);

 private:
  // Triangles of one draw, or of several without an image.
  struct ImageRun {
    TriangleRange triangles;
    const ImageBuffer* image = nullptr;
  };
  struct Drawn {
    explicit Drawn(const gl::Functions& gl) : triangles(gl), colors(gl), seen(gl) {}
    TriangleBuffers triangles;
    TriangleColors colors;
    TriangleColors seen;
    std::optional<MorphBuffers> morphs;     // while vertices may morph
    std::optional<VertexBuffers> vertices;  // only for an HLOD, which has its own
    std::vector<ImageRun> runs;             // of all triangles; empty where no node shows an image of its own
  };
  struct Side {
    std::uint64_t number = 0;    // of the refinement, or of the front
    std::vector<Drawn> objects;  // in the frame's order
  };
  void keep_vertices_of(const Objects& objects);
  std::size_t upload(Side& side, const RefinedSide& refined);
  std::size_t upload(Side& side, const HlodSide& drawn);
  // Lists the runs of each object of a side. Returns how many bytes it uploads.
  std::size_t upload_images(Side& side, const HlodSide& drawn);
  void drop_unshown_images();
  void fit(Side& side) const;
  std::size_t upload_morphs(Drawn& drawn, const PlacedObject& object, std::span<const Geomorph> geomorphs);
  [[nodiscard]] bool has_own_colors(std::size_t side, const LookSettings& look) const;
  void draw_object(const PlacedObject& object, const Drawn& drawn, const TriangleColors& colors, bool own_colors,
                   const View& view, const LookSettings& look) const;
  void draw_triangles(const Drawn& drawn, MeshProgram::Uniforms& uniforms, const LookSettings& look) const;

  const gl::Functions* gl_;
  MeshProgram plain_;
  MeshProgram wire_;
  BackgroundProgram background_;
  LineDrawing lines_;
  std::shared_ptr<const RefinedFrame> frame_;
  std::map<std::shared_ptr<const ViewMesh>, VertexBuffers> vertices_;
  std::map<std::shared_ptr<const LayeredTexture>, LayerBuffer> layers_;  // of meshes with materials
  std::map<std::shared_ptr<const Image>, ImageBuffer> images_;           // of nodes that a side shows
  std::vector<Side> sides_;
  ClipPlane clip_plane_;
  bool is_hlod_ = false;  // whether the frame is of HLODs
};

}  // namespace occlod::viewer
