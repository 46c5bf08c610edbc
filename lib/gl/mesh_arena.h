// Which parts of a buffer are in use. No OpenGL here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "gl/objects.h"
#include "occlod/device.h"
#include "occlod/gl.h"

namespace occlod::gl {

// Ranges of [0, size) that do not overlap; free neighbours are one.
class RangeAllocator {
 public:
  explicit RangeAllocator(std::size_t size);
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  // The start of a free range of so many, > 0: the first in the smallest gap that has room. O(gaps).
  [[nodiscard]] std::optional<std::size_t> take(std::size_t count);
  // Frees a range as take() gave it. O(log gaps).
  void give_back(std::size_t first, std::size_t count);

 private:
  std::size_t size_;
  std::map<std::size_t, std::size_t> gaps_;  // first to count
};

// Meshes of nodes in OpenGL's buffers: uploaded when they are wanted, the longest unused ones given up for others.

// A vertex as the node program reads it.
struct ArenaVertex {
  glm::vec3 position{0.0F};  // location 0; object space
  glm::u8vec4 color{0};      // location 1; sRGB
  glm::vec3 merged{0.0F};    // location 2; where it slides to
};
static_assert(sizeof(ArenaVertex) == 28);

// Where a mesh lies.
struct ArenaPlace {
  GLuint array = 0;             // vertex array to bind
  GLint base_vertex = 0;        // of the mesh, for draws by its own indices
  std::size_t first_index = 0;  // bytes from the start of the index buffer

  // Of an index of the mesh, as OpenGL takes it: the offset into the bound buffer as a pointer.
  [[nodiscard]] const void* index_pointer(std::uint32_t index) const noexcept {
    const std::size_t bytes = first_index + index * sizeof(std::uint16_t);
    return reinterpret_cast<const void*>(bytes);  // NOLINT(performance-no-int-to-ptr)
  }
};

// Buffers of equal size, each holding vertices and indices, as many as the budget has room for. Lives in a context that
// is current in every call.
class MeshArena {
 public:
  // before_eviction: called before any mesh makes room for another, so that what is to be drawn from it is given to
  // OpenGL.
  MeshArena(const Functions& gl, std::size_t budget_bytes, std::function<void()> before_eviction);

  // Meshes of these objects may be wanted until the next call; those of other HLODs are given up. Throws Error when a
  // mesh is larger than the budget.
  void begin_frame(std::span<const hlod::PlacedHlod> objects);
  // The mesh of a node, without or with the places that its vertices slide to; uploaded where it is not there. It may
  // take the place of any other. Throws Error when the mesh is damaged.
  [[nodiscard]] ArenaPlace place(std::uint32_t object, hlod::NodeId node, bool morphs);
  // Likewise a node refined within: NodeDraw::splits and NodeDraw::cut, whose vertices do not slide.
  [[nodiscard]] ArenaPlace place_cut(std::uint32_t object, hlod::NodeId node, std::uint32_t splits,
                                     std::span<const std::uint16_t> cut);

  [[nodiscard]] const MeshMemory& memory() const noexcept { return memory_; }

 private:
  struct Held;
  // A mesh that is there.
  struct Slot {
    Held* of = nullptr;
    std::uint64_t key = 0;     // key_of()
    std::size_t chunk = 0;     // into chunks_
    std::size_t first = 0;     // vertices
    std::size_t vertices = 0;  // of the mesh
    std::size_t count = 0;     // vertices that vertices and indices take the room of
    bool filled = false;       // uploaded
    bool morphs = false;       // likewise, with where vertices slide to
  };
  using Slots = std::list<Slot>;
  // An HLOD and which of its meshes are there. The copy keeps its arrays, and so what identifies it, from being
  // replaced by those of another.
  struct Held {
    hlod::Hlod hlod;
    std::unordered_map<std::uint64_t, Slots::iterator> slots;  // by key
    std::size_t largest = 0;                                   // room that its largest mesh takes
    bool wanted = false;                                       // by this frame
  };
  struct Chunk {
    Chunk(const Functions& gl, std::size_t vertices);
    VertexArray array;
    Buffer buffer;
    RangeAllocator ranges;
  };

  [[nodiscard]] Held& hold(const hlod::Hlod& hlod);
  void drop_unwanted();
  void fit_chunks();
  [[nodiscard]] Slot& slot_of(Held& held, std::uint64_t key, std::size_t vertices, std::size_t indices);
  void upload(Slot& slot, std::span<const std::uint16_t> indices);
  [[nodiscard]] bool take_range(Slot& slot);
  [[nodiscard]] bool add_chunk();
  void remove(Slots::iterator slot);
  [[nodiscard]] ArenaPlace place_of(const Slot& slot) const;

  const Functions* gl_;
  std::size_t budget_;      // vertices
  std::size_t chunk_size_;  // vertices
  std::function<void()> before_eviction_;
  std::vector<Chunk> chunks_;
  std::unordered_map<const hlod::Node*, Held> held_;  // by where their nodes lie
  std::vector<Held*> objects_;                        // of the frame
  Slots slots_;                                       // the longest unused first
  std::vector<ArenaVertex> staging_;
  MeshMemory memory_;
};

// Draws of nodes that are gathered, and then given to OpenGL by one call for each object and buffer of meshes.

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
