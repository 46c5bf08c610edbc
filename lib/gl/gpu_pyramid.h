// The depth pyramid of the software backend in a storage buffer: levels of farthest nearness, finest first.
#pragma once

#include <vector>

#include "gl/objects.h"
#include "gl/occluder_mesh.h"

namespace occlod::gl {

// Lives in a context of OpenGL 4.3 that is current in every call.
class GpuPyramid {
 public:
  explicit GpuPyramid(const Functions& gl);

  // Draws the occluder into an image of this size, rows from the top, and reduces it until one texel is left. Odd sizes
  // round up.
  void build(const OccluderMesh& occluder, const View& view);
  // Binds the texels to a storage buffer and the levels' (first texel, width) to an array of ivec2.
  void use(GLuint binding, GLint levels_uniform) const;

 private:
  struct Level {
    GLint first = 0;  // texel
    GLint width = 0;
    GLint height = 0;
  };
  void lay_out(int width, int height);
  void draw(const OccluderMesh& occluder, bool orthographic) const;
  void copy_finest() const;
  void reduce() const;

  const Functions* gl_;
  FloatTarget target_;
  Program draw_;
  Program reduce_;
  OccluderBuffer occluder_;
  Buffer texels_;
  std::vector<Level> levels_;
};

}  // namespace occlod::gl
