#include "mesh/split_vertices.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <span>

#include "base/scratch_memory.h"
#include "base/portable_math.h"

namespace occlod {
namespace {

using Corner = AttributeCorner;

constexpr std::size_t corners_between_looks = 4096;  // whether memory has room

template <class Storage>
class VertexSplitter {
 public:
  VertexSplitter(BasicPolygonSoup<Storage>& soup, const CornerAttributes<Storage>& attributes)
      : soup_(soup),
        values_(attributes),
        vertices_(soup.positions.size()),
        first_(vertices_),
        is_used_(vertices_),
        slots_(64, no_id) {}

  // False where there are more vertices than ids.
  [[nodiscard]] bool run() {
    const std::span<VertexId> ids = soup_.corners();
    for (std::size_t i = 0; i < ids.size(); ++i) {
      if (i % corners_between_looks == 0) make_room();
      const Corner corner = i < values_.corners.size() ? values_.corners[i] : Corner{};
      has_texture_ |= corner.texture != no_id;
      has_normal_ |= corner.normal != no_id;
      ids[i] = vertex_for(ids[i], corner);
      if (vertices_ + added_.size() >= max_vertices) return false;
    }
    append_vertices();
    return true;
  }

 private:
  template <class T>
  using Array = typename Storage::template Array<T>;

  struct Added {
    VertexId vertex;  // that it repeats
    Corner corner;
  };

  VertexId vertex_for(VertexId vertex, const Corner& corner) {
    if (!is_used_[vertex]) {
      is_used_[vertex] = true;
      first_[vertex] = corner;
      return vertex;
    }
    if (is_same(first_[vertex], corner)) return vertex;
    if (2 * added_.size() >= slots_.size()) grow();
    std::size_t slot = hash_of({vertex, corner}) & (slots_.size() - 1);
    while (slots_[slot] != no_id && !is_same(added_[slots_[slot]], {vertex, corner}))
      slot = (slot + 1) & (slots_.size() - 1);
    if (slots_[slot] == no_id) {
      slots_[slot] = static_cast<std::uint32_t>(added_.size());
      added_.push_back({vertex, corner});
    }
    return static_cast<VertexId>(vertices_ + slots_[slot]);
  }

  [[nodiscard]] glm::vec2 texture_of(const Corner& corner) const {
    return corner.texture == no_id ? glm::vec2(0.0F) : values_.texture_coordinates[corner.texture];
  }
  [[nodiscard]] glm::vec3 normal_of(const Corner& corner) const {
    return corner.normal == no_id ? glm::vec3(0.0F) : values_.normals[corner.normal];
  }
  static std::uint64_t bits(float a, float b) {
    return std::bit_cast<std::uint32_t>(a) | std::uint64_t{std::bit_cast<std::uint32_t>(b)} << 32;
  }

  // By value, to the bit: many files have equal values under several indices, and some have NaN.
  [[nodiscard]] bool is_same(const Corner& a, const Corner& b) const {
    if (a == b) return true;
    const glm::vec2 s = texture_of(a), t = texture_of(b);
    const glm::vec3 m = normal_of(a), n = normal_of(b);
    return bits(s.x, s.y) == bits(t.x, t.y) && bits(m.x, m.y) == bits(n.x, n.y) && bits(m.z, 0) == bits(n.z, 0);
  }
  [[nodiscard]] bool is_same(const Added& a, const Added& b) const {
    return a.vertex == b.vertex && is_same(a.corner, b.corner);
  }
  [[nodiscard]] std::size_t hash_of(const Added& of) const {
    const glm::vec2 t = texture_of(of.corner);
    const glm::vec3 n = normal_of(of.corner);
    return scatter(scatter(scatter(of.vertex + bits(t.x, t.y)) + bits(n.x, n.y)) + bits(n.z, 0));
  }

  void grow() {
    slots_.assign(2 * slots_.size(), no_id);
    for (std::uint32_t i = 0; i < added_.size(); ++i) {
      std::size_t slot = hash_of(added_[i]) & (slots_.size() - 1);
      while (slots_[slot] != no_id) slot = (slot + 1) & (slots_.size() - 1);
      slots_[slot] = i;
    }
  }

  void append_vertices() {
    repeat(soup_.positions);
    repeat(soup_.normals);
    repeat(soup_.colors);
    soup_.added_vertices += added_.size();
    if (has_texture_) take(soup_.texture_coordinates, [this](const Corner& corner) { return texture_of(corner); });
    if (has_normal_) take(soup_.normals, [this](const Corner& corner) { return normal_of(corner); });
  }

  template <class T>
  void repeat(Array<T>& values) const {
    if (values.empty()) return;
    values.reserve(vertices_ + added_.size());
    for (const Added& added : added_) values.push_back(values[added.vertex]);
  }

  template <class T, class ValueOf>
  void take(Array<T>& values, ValueOf value_of) const {
    values.clear();
    values.reserve(vertices_ + added_.size());
    for (const Corner& corner : first_) values.push_back(value_of(corner));
    for (const Added& added : added_) values.push_back(value_of(added.corner));
  }

  BasicPolygonSoup<Storage>& soup_;
  const CornerAttributes<Storage>& values_;
  std::size_t vertices_;   // before
  Array<Corner> first_;    // by vertex
  Array<bool> is_used_;    // by vertex
  Array<Added> added_;     // vertices_ on
  Array<VertexId> slots_;  // into added_: open addressing, at most half full
  bool has_texture_ = false;
  bool has_normal_ = false;
};

}  // namespace

template <class Storage>
void split_vertices(BasicPolygonSoup<Storage>& soup, const CornerAttributes<Storage>& attributes,
                    const FileErrors& errors) {
  if (!VertexSplitter<Storage>(soup, attributes).run())
    errors.fail("", "has too many vertices with attributes of their own", "split the mesh into parts");
}

template void split_vertices(PolygonSoup&, const CornerAttributes<InMemory>&, const FileErrors&);
template void split_vertices(ScratchSoup&, const CornerAttributes<InScratch>&, const FileErrors&);

}  // namespace occlod
