#include "gl/mesh_arena.h"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <iterator>
#include <string>
#include <utility>

#include "gl/programs.h"
#include "occlod/base.h"
#include "scene/color.h"

namespace occlod::gl {

RangeAllocator::RangeAllocator(std::size_t size) : size_(size) {
  if (size > 0) gaps_.emplace(0, size);
}

std::optional<std::size_t> RangeAllocator::take(std::size_t count) {
  assert(count > 0);
  auto best = gaps_.end();
  for (auto gap = gaps_.begin(); gap != gaps_.end(); ++gap)
    if (gap->second >= count && (best == gaps_.end() || gap->second < best->second)) best = gap;
  if (best == gaps_.end()) return std::nullopt;
  const auto [first, free] = *best;
  gaps_.erase(best);
  if (free > count) gaps_.emplace(first + count, free - count);
  return first;
}

void RangeAllocator::give_back(std::size_t first, std::size_t count) {
  assert(count > 0 && first + count <= size_);
  auto gap = gaps_.emplace(first, count).first;
  const auto next = std::next(gap);
  assert(next == gaps_.end() || first + count <= next->first);
  if (next != gaps_.end() && next->first == first + count) {
    gap->second += next->second;
    gaps_.erase(next);
  }
  if (gap == gaps_.begin()) return;
  const auto before = std::prev(gap);
  assert(before->first + before->second <= first);
  if (before->first + before->second != first) return;
  before->second += gap->second;
  gaps_.erase(gap);
}

namespace {

// Larger chunks are harder to allocate; smaller ones cause more changes of the vertex array.
constexpr std::size_t usual_chunk_bytes = std::size_t{16} << 20;

// Returns the size of a mesh's vertices and indices in units of vertices.
std::size_t room_for(std::size_t vertices, std::size_t indices) {
  return vertices + (indices * sizeof(std::uint16_t) + sizeof(ArenaVertex) - 1) / sizeof(ArenaVertex);
}

// Returns the size of node n, either as it is or with all its splits, whichever is larger.
std::size_t max_room(const hlod::HlodView& data, hlod::NodeId n) {
  const hlod::Node& node = data.nodes[n];
  const std::size_t plain = room_for(node.vertices, 3 * std::size_t{node.triangles});
  if (data.within.empty()) return plain;
  const hlod::NodeWithin& within = data.within[n];
  const std::size_t vertices = std::size_t{node.vertices} + within.bare + within.splits;
  return std::max(plain, room_for(vertices, 3 * std::size_t{within.triangles}));
}

// Returns the key of a mesh within one HLOD: a node's own mesh, or its mesh with this many splits.
std::uint64_t key_of(hlod::NodeId node) { return node; }
std::uint64_t key_of_cut(hlod::NodeId node, std::uint32_t splits) { return (std::uint64_t{splits} + 1) << 32U | node; }

// Converts an offset into the bound buffer to the pointer that OpenGL expects.
const void* offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);  // NOLINT(performance-no-int-to-ptr)
}

// Fills vertices that do not morph; `colors` may be empty.
void fill_vertices(std::span<ArenaVertex> vertices, std::span<const glm::vec3> positions,
                   std::span<const glm::u8vec4> colors) {
  const glm::u8vec4 base = picture::to_srgb(ShadeOptions{}.base);
  for (std::size_t v = 0; v < positions.size(); ++v)
    vertices[v] = {positions[v], colors.empty() ? base : colors[v], positions[v]};
}

// Fills vertices that morph towards the mesh of the parent whose patch uses them.
void fill_merged(std::span<ArenaVertex> vertices, const hlod::Hlod& hlod, hlod::NodeId node) {
  const hlod::NodeMesh mesh = hlod.mesh(node);
  for (const hlod::Patch& patch : hlod.patches(node)) {
    if (patch.parent == no_id) continue;
    const hlod::NodeMesh parent = hlod.mesh(patch.parent);
    for (const std::uint16_t v : mesh.indices.subspan(patch.first_index, patch.index_count))
      if (mesh.merged_into[v] != hlod::stays) vertices[v].merged = parent.positions[mesh.merged_into[v]];
  }
}

void require_parents(const hlod::Hlod& hlod, hlod::NodeId node) {
  for (const hlod::Patch& patch : hlod.patches(node))
    if (patch.parent != no_id) hlod.require(patch.parent);
}

}  // namespace

MeshArena::Chunk::Chunk(const Functions& gl, std::size_t vertices) : array(gl), buffer(gl), ranges(vertices) {
  constexpr auto stride = static_cast<GLsizei>(sizeof(ArenaVertex));
  gl.BindVertexArray(array.id());
  gl.BindBuffer(GL_ARRAY_BUFFER, buffer.id());
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffer.id());
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices * sizeof(ArenaVertex)), nullptr, GL_DYNAMIC_DRAW);
  for (const GLuint location : {0U, 1U, 2U}) gl.EnableVertexAttribArray(location);
  gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, stride, offset(offsetof(ArenaVertex, position)));
  gl.VertexAttribPointer(1, 4, GL_UNSIGNED_BYTE, GL_TRUE, stride, offset(offsetof(ArenaVertex, color)));
  gl.VertexAttribPointer(2, 3, GL_FLOAT, GL_FALSE, stride, offset(offsetof(ArenaVertex, merged)));
  check(gl, "memory for meshes");
}

MeshArena::MeshArena(const Functions& gl, std::size_t budget_bytes, std::function<void()> before_eviction)
    : gl_(&gl),
      budget_(budget_bytes / sizeof(ArenaVertex)),
      chunk_size_(std::min(budget_, usual_chunk_bytes / sizeof(ArenaVertex))),
      before_eviction_(std::move(before_eviction)) {}

void MeshArena::begin_frame(std::span<const hlod::PlacedHlod> objects) {
  for (auto& [nodes, held] : held_) held.wanted = false;
  objects_.clear();
  for (const hlod::PlacedHlod& object : objects) objects_.push_back(&hold(*object.hlod));
  drop_unwanted();
  fit_chunks();
}

MeshArena::Held& MeshArena::hold(const hlod::Hlod& hlod) {
  const auto [found, is_new] = held_.try_emplace(hlod.data().nodes.data());
  Held& held = found->second;
  held.wanted = true;
  if (!is_new) return held;
  held.hlod = hlod;
  for (hlod::NodeId n = 0; n < hlod.node_count(); ++n) held.largest = std::max(held.largest, max_room(hlod.data(), n));
  return held;
}

void MeshArena::drop_unwanted() {
  for (auto slot = slots_.begin(); slot != slots_.end();) {
    const auto next = std::next(slot);
    if (!slot->of->wanted) remove(slot);
    slot = next;
  }
  std::erase_if(held_, [](const auto& entry) { return !entry.second.wanted; });
}

// Makes chunks large enough for any mesh of the frame.
void MeshArena::fit_chunks() {
  std::size_t largest = 0;
  for (const auto& [nodes, held] : held_) largest = std::max(largest, held.largest);
  if (largest > budget_)
    throw Error({"gl device", "mesh_bytes",
                 "is " + std::to_string(budget_ * sizeof(ArenaVertex)) + ", and one mesh takes " +
                     std::to_string(largest * sizeof(ArenaVertex)),
                 "allow the device more memory for meshes"});
  if (largest <= chunk_size_) return;
  while (!slots_.empty()) remove(slots_.begin());
  chunks_.clear();
  chunk_size_ = largest;
}

ArenaPlace MeshArena::place(std::uint32_t object, hlod::NodeId node, bool morphs) {
  assert(object < objects_.size());
  Held& held = *objects_[object];
  held.hlod.require(node);
  if (morphs) require_parents(held.hlod, node);
  const hlod::NodeMesh mesh = held.hlod.mesh(node);
  Slot& slot = slot_of(held, key_of(node), mesh.positions.size(), mesh.indices.size());
  if (slot.filled && (slot.morphs || !morphs)) return place_of(slot);
  staging_.resize(slot.count);
  fill_vertices(staging_, mesh.positions, mesh.colors);
  if (morphs) fill_merged(staging_, held.hlod, node);
  upload(slot, mesh.indices);
  slot.morphs = morphs;
  return place_of(slot);
}

ArenaPlace MeshArena::place_cut(std::uint32_t object, hlod::NodeId node, std::uint32_t splits,
                                std::span<const std::uint16_t> cut) {
  assert(object < objects_.size());
  Held& held = *objects_[object];
  held.hlod.require(node);
  held.hlod.require_within(node);
  const hlod::NodeMesh mesh = held.hlod.mesh(node);
  const hlod::NodeSplits within = held.hlod.within(node);
  const std::size_t added = within.positions.size() - within.parents.size() + splits;
  const std::size_t own = mesh.positions.size();
  Slot& slot = slot_of(held, key_of_cut(node, splits), own + added, cut.size());
  if (slot.filled) return place_of(slot);
  staging_.resize(slot.count);
  fill_vertices(staging_, mesh.positions, mesh.colors);
  fill_vertices(std::span(staging_).subspan(own), within.positions.first(added),
                within.colors.empty() ? within.colors : within.colors.first(added));
  upload(slot, cut);
  return place_of(slot);
}

// Returns the slot with this key, marked as most recently used; a new empty one if there was none.
MeshArena::Slot& MeshArena::slot_of(Held& held, std::uint64_t key, std::size_t vertices, std::size_t indices) {
  if (const auto found = held.slots.find(key); found != held.slots.end()) {
    slots_.splice(slots_.end(), slots_, found->second);
    return slots_.back();
  }
  Slot slot{&held, key, 0, 0, vertices, room_for(vertices, indices)};
  assert(slot.count <= held.largest);
  while (!take_range(slot)) {
    if (add_chunk()) continue;
    before_eviction_();
    remove(slots_.begin());
    ++memory_.evictions;
  }
  held.slots.emplace(key, slots_.insert(slots_.end(), slot));
  ++memory_.nodes;
  memory_.bytes += slot.count * sizeof(ArenaVertex);
  return slots_.back();
}

bool MeshArena::take_range(Slot& slot) {
  for (std::size_t i = 0; i < chunks_.size(); ++i)
    if (const auto first = chunks_[i].ranges.take(slot.count)) {
      slot.chunk = i;
      slot.first = *first;
      return true;
    }
  return false;
}

// Adds a chunk; what is left of the budget becomes a smaller one. Returns false when nothing is left.
bool MeshArena::add_chunk() {
  std::size_t size = budget_;
  for (const Chunk& chunk : chunks_) size -= chunk.ranges.size();
  if (size == 0) return false;
  chunks_.emplace_back(*gl_, std::min(size, chunk_size_));
  return true;
}

// Uploads a mesh whose vertices are in staging_.
void MeshArena::upload(Slot& slot, std::span<const std::uint16_t> indices) {
  std::memcpy(static_cast<void*>(staging_.data() + slot.vertices), indices.data(), indices.size_bytes());
  gl_->BindBuffer(GL_ARRAY_BUFFER, chunks_[slot.chunk].buffer.id());
  gl_->BufferSubData(GL_ARRAY_BUFFER, static_cast<GLintptr>(slot.first * sizeof(ArenaVertex)),
                     static_cast<GLsizeiptr>(slot.count * sizeof(ArenaVertex)), staging_.data());
  slot.filled = true;
  ++memory_.uploads;
}

ArenaPlace MeshArena::place_of(const Slot& slot) const {
  return {chunks_[slot.chunk].array.id(), static_cast<GLint>(slot.first),
          (slot.first + slot.vertices) * sizeof(ArenaVertex)};
}

void MeshArena::remove(Slots::iterator slot) {
  chunks_[slot->chunk].ranges.give_back(slot->first, slot->count);
  slot->of->slots.erase(slot->key);
  --memory_.nodes;
  memory_.bytes -= slot->count * sizeof(ArenaVertex);
  slots_.erase(slot);
}

DrawKind& GatheredDraws::kind_of(std::uint32_t object, GLuint array) {
  for (DrawKind& kind : std::span(kinds_).first(used_))
    if (kind.object == object && kind.array == array) return kind;
  if (used_ == kinds_.size()) kinds_.emplace_back();
  DrawKind& kind = kinds_[used_++];
  kind.object = object;
  kind.array = array;
  kind.commands.clear();
  kind.morphs.clear();
  return kind;
}

void GatheredDraws::add(std::uint32_t object, const ArenaPlace& place, std::span<const hlod::DrawRange> ranges) {
  DrawKind& kind = kind_of(object, place.array);
  const auto first = static_cast<GLuint>(place.first_index / sizeof(std::uint16_t));
  const std::size_t first_command = kind.commands.size();
  std::uint32_t end = 0;
  for (const hlod::DrawRange& range : ranges) {
    const bool goes_on =
        kind.commands.size() > first_command && range.first_index == end && range.morph == kind.morphs.back();
    end = range.first_index + range.index_count;
    if (goes_on) {
      kind.commands.back().count += range.index_count;
      continue;
    }
    const auto instance = static_cast<GLuint>(kind.commands.size());
    kind.commands.push_back({range.index_count, 1, first + range.first_index, place.base_vertex, instance});
    kind.morphs.push_back(range.morph);
  }
}

void GatheredDraws::draw(const DrawKind& kind) {
  assert(!kind.commands.empty());
  gl_->BindVertexArray(kind.array);
  set_morphs(kind.morphs);
  gl_->BindBuffer(GL_DRAW_INDIRECT_BUFFER, commands_.id());
  fill(*gl_, GL_DRAW_INDIRECT_BUFFER, std::span<const DrawCommand>(kind.commands), GL_STREAM_DRAW);
  gl_->MultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_SHORT, nullptr, static_cast<GLsizei>(kind.commands.size()),
                                 0);
  gl_->DisableVertexAttribArray(NodeProgram::morph_location);
}

// Uses an array only where factors differ: single draws from the same vertex array have one factor for all vertices.
void GatheredDraws::set_morphs(std::span<const GLfloat> morphs) {
  if (std::all_of(morphs.begin(), morphs.end(), [&](GLfloat morph) { return morph == morphs.front(); }))
    return gl_->VertexAttrib1f(NodeProgram::morph_location, morphs.front());
  gl_->BindBuffer(GL_ARRAY_BUFFER, morphs_.id());
  fill(*gl_, GL_ARRAY_BUFFER, morphs, GL_STREAM_DRAW);
  gl_->EnableVertexAttribArray(NodeProgram::morph_location);
  gl_->VertexAttribPointer(NodeProgram::morph_location, 1, GL_FLOAT, GL_FALSE, 0, nullptr);
  gl_->VertexAttribDivisor(NodeProgram::morph_location, 1);
}

}  // namespace occlod::gl
