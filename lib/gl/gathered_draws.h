// Draws of nodes that are gathered, and then given to OpenGL by one call for each object and buffer of meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "gl/mesh_arena.h"
#include "gl/objects.h"
#include "occlod/device/device.h"

namespace occlod::gl {

// As glMultiDrawElementsIndirect reads it.
struct DrawCommand {
  GLuint count = 0;
  GLuint instances = 1;
  GLuint first_index = 0;  // into the index buffer
  GLint base_vertex = 0;
  GLuint base_instance = 0;  // into the factors by which draws morph
};
static_assert(sizeof(DrawCommand) == 20);

// Draws of one object from one buffer of meshes.
struct DrawKind {
  std::uint32_t object = 0;
  GLuint array = 0;                   // vertex array
  std::vector<DrawCommand> commands;  // at least one
  std::vector<GLfloat> morphs;        // by command
};

// Lives in a context that is current in every call and has Functions::MultiDrawElementsIndirect.
class GatheredDraws {
 public:
  explicit GatheredDraws(const Functions& gl) : gl_(&gl), commands_(gl), morphs_(gl) {}

  // Ranges of a mesh, at least one, ascending; adjacent ones that morph alike are one.
  void add(std::uint32_t object, const ArenaPlace& place, std::span<const hlod::DrawRange> ranges);
  [[nodiscard]] bool empty() const noexcept { return used_ == 0; }
  // In the order in which each had its first draw.
  [[nodiscard]] std::span<const DrawKind> kinds() const noexcept { return std::span(kinds_).first(used_); }
  // Draws all of a kind by one call, in the order in which they were added, with the program in use.
  void draw(const DrawKind& kind);
  // Forgets all of them.
  void clear() noexcept { used_ = 0; }

 private:
  [[nodiscard]] DrawKind& kind_of(std::uint32_t object, GLuint array);
  void set_morphs(std::span<const GLfloat> morphs);

  const Functions* gl_;
  Buffer commands_;
  Buffer morphs_;
  std::vector<DrawKind> kinds_;  // those beyond used_ keep their memory
  std::size_t used_ = 0;
};

}  // namespace occlod::gl
