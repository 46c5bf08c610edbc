// Tracks which parts of a buffer are in use. Does not call OpenGL.
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

// Manages disjoint ranges of [0, size); adjacent free ranges are merged.
class RangeAllocator {
 public:
  explicit RangeAllocator(std::size_t size);
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  // Takes `count` > 0 elements from the start of the first of the smallest free ranges that are large enough. O(gaps).
  [[nodiscard]] std::optional<std::size_t> take(std::size_t count);
  // Frees a range that take() returned. O(log gaps).
  void give_back(std::size_t first, std::size_t count);

 private:
  std::size_t size_;
  std::map<std::size_t, std::size_t> gaps_;  // from first element to count
};

// Stores meshes of nodes in OpenGL buffers: uploads them on demand and evicts the least recently used ones.

// Defines a vertex as the node program reads it.
struct ArenaVertex {
  glm::vec3 position{0.0F};  // location 0; object space
  glm::u8vec4 color{0};      // location 1; sRGB
  glm::vec3 merged{0.0F};    // location 2; the position it morphs to
};
static_assert(sizeof(ArenaVertex) == 28);

// Tells where a mesh is stored.
struct ArenaPlace {
  GLuint array = 0;             // vertex array to bind
  GLint base_vertex = 0;        // of the mesh, for draws with its own indices
  std::size_t first_index = 0;  // bytes from the start of the index buffer

  // Returns an index of the mesh as OpenGL expects it: the offset into the bound buffer as a pointer.
  [[nodiscard]] const void* index_pointer(std::uint32_t index) const noexcept {
    const std::size_t bytes = first_index + index * sizeof(std::uint16_t);
    return reinterpret_cast<const void*>(bytes);  // NOLINT(performance-no-int-to-ptr)
  }
};

// Holds buffers of equal size, each with vertices and indices, as many as fit into the budget. Lives in a context that
// must be current in every call.
class MeshArena {
 public:
  // `before_eviction` is called before any mesh is evicted, so that pending draws from it can be submitted first.
  MeshArena(const Functions& gl, std::size_t budget_bytes, std::function<void()> before_eviction);

  // Starts a frame: meshes of these objects may be requested until the next call, and those of other HLODs are evicted.
  // Throws Error when a mesh is larger than the budget.
  void begin_frame(std::span<const hlod::PlacedHlod> objects);
  // Returns the mesh of a node, with or without morph targets; uploads it if necessary, which may evict any other mesh.
  // Throws Error when the mesh is damaged.
  [[nodiscard]] ArenaPlace place(std::uint32_t object, hlod::NodeId node, bool morphs);
  // Returns the mesh of a node refined by part of its splits (NodeDraw::splits and NodeDraw::cut), whose vertices do
  // not morph. Uploads, evicts and throws like place().
  [[nodiscard]] ArenaPlace place_cut(std::uint32_t object, hlod::NodeId node, std::uint32_t splits,
                                     std::span<const std::uint16_t> cut);

  [[nodiscard]] const MeshMemory& memory() const noexcept { return memory_; }

 private:
  struct Held;
  // Describes an uploaded mesh.
  struct Slot {
    Held* of = nullptr;
    std::uint64_t key = 0;     // see key_of()
    std::size_t chunk = 0;     // index into chunks_
    std::size_t first = 0;     // in vertices
    std::size_t vertices = 0;  // number of vertices of the mesh
    std::size_t count = 0;     // size of vertices and indices, in vertices
    bool filled = false;       // whether it is uploaded
    bool morphs = false;       // whether it is uploaded with morph targets
  };
  using Slots = std::list<Slot>;
  // Holds an HLOD and its uploaded meshes. The copy keeps the HLOD's arrays alive, so that their addresses, which
  // identify it, are not reused for another HLOD.
  struct Held {
    hlod::Hlod hlod;
    std::unordered_map<std::uint64_t, Slots::iterator> slots;  // by key
    std::size_t largest = 0;                                   // size of its largest mesh, in vertices
    bool wanted = false;                                       // whether this frame uses it
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
  std::size_t budget_;      // in vertices
  std::size_t chunk_size_;  // in vertices
  std::function<void()> before_eviction_;
  std::vector<Chunk> chunks_;
  std::unordered_map<const hlod::Node*, Held> held_;  // keyed by the address of their nodes
  std::vector<Held*> objects_;                        // per object of the frame
  Slots slots_;                                       // least recently used first
  std::vector<ArenaVertex> staging_;
  MeshMemory memory_;
};

// Collects draws of nodes and submits them by one call per object and mesh buffer.

// Matches the layout that glMultiDrawElementsIndirect reads.
struct DrawCommand {
  GLuint count = 0;
  GLuint instances = 1;
  GLuint first_index = 0;  // index into the index buffer
  GLint base_vertex = 0;
  GLuint base_instance = 0;  // index into the morph factors of draws
};
static_assert(sizeof(DrawCommand) == 20);

// Holds the draws of one object from one mesh buffer.
struct DrawKind {
  std::uint32_t object = 0;
  GLuint array = 0;                   // vertex array
  std::vector<DrawCommand> commands;  // at least one
  std::vector<GLfloat> morphs;        // one per command
};

// Lives in a context that must be current in every call and must have Functions::MultiDrawElementsIndirect.
class GatheredDraws {
 public:
  explicit GatheredDraws(const Functions& gl) : gl_(&gl), commands_(gl), morphs_(gl) {}

  // Adds ranges of a mesh, at least one, ascending; adjacent ranges that morph alike are merged.
  void add(std::uint32_t object, const ArenaPlace& place, std::span<const hlod::DrawRange> ranges);
  [[nodiscard]] bool empty() const noexcept { return used_ == 0; }
  // Returns the kinds in the order in which each had its first draw.
  [[nodiscard]] std::span<const DrawKind> kinds() const noexcept { return std::span(kinds_).first(used_); }
  // Draws everything of a kind by one call, in the order in which it was added, with the program in use.
  void draw(const DrawKind& kind);
  // Drops all collected draws.
  void clear() noexcept { used_ = 0; }

 private:
  [[nodiscard]] DrawKind& kind_of(std::uint32_t object, GLuint array);
  void set_morphs(std::span<const GLfloat> morphs);

  const Functions* gl_;
  Buffer commands_;
  Buffer morphs_;
  std::vector<DrawKind> kinds_;  // entries from used_ on only keep their memory
  std::size_t used_ = 0;
};

}  // namespace occlod::gl
