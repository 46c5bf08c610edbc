// Draws lines in world space of any width.
#pragma once

#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "gl/objects.h"
#include "occlod/view.h"

namespace occlod::viewer {

struct Pen {
  glm::vec4 color{1.0F};  // sRGB and alpha
  double width_px = 1.5;
  double hidden_alpha = 0.15;  // factor for lines that the mesh hides
};

struct Line {
  glm::dvec3 a{0.0};
  glm::dvec3 b{0.0};
  Pen pen;
};

class LineDrawing {
 public:
  explicit LineDrawing(const gl::Functions& gl);
  // Draws over a mesh that was drawn with depth.
  void draw(const std::vector<Line>& lines, const View& view);

 private:
  struct Vertex {
    glm::vec4 clip{0.0F};
    glm::vec4 color{0.0F};
    float hidden_alpha = 0.0F;
  };
  void append(const Line& line, const View& view);

  const gl::Functions* gl_;
  gl::Program program_;
  GLint hidden_;
  gl::VertexArray array_;
  gl::Buffer buffer_;
  std::vector<Vertex> vertices_;
};

}  // namespace occlod::viewer
