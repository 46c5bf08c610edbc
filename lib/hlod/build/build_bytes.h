// Turns groups and nodes of a build into bytes and back, for the files in which it keeps them.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "hlod/build/finish_level.h"
#include "hlod/build/group_simplifier.h"
#include "occlod/bounds.h"

namespace occlod::hlod {

template <typename T>
std::span<const std::byte> bytes_of(const T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::as_bytes(std::span<const T, 1>(&value, 1));
}

template <typename T>
std::span<std::byte> writable_bytes_of(T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::as_writable_bytes(std::span<T, 1>(&value, 1));
}

inline void put_bytes(std::vector<std::byte>& to, std::span<const std::byte> bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

// Moves the first bytes of `from` to `to`. Precondition: there are as many. A checksum guarantees that put_bytes()
// wrote them.
inline void get_bytes(std::span<const std::byte>& from, std::span<std::byte> to) {
  assert(to.size() <= from.size());
  std::copy_n(from.begin(), to.size(), to.begin());
  from = from.subspan(to.size());
}

// Holds what a node has besides its arrays.
struct NodeFacts {
  Box box;
  float error = 0.0F, guaranteed_error = 0.0F;
};
static_assert(sizeof(NodeFacts) == 32 && sizeof(NewWedge) == 20 && sizeof(Merge) == 8 &&
              sizeof(SplitsDraft::Split) == 8 && sizeof(GrownBox) == 28);  // no padding, whose bytes nobody has set

// Calls visit() for each array of a node, or of a group but its triangles and boxes, to write or to read it.
template <typename Node, typename Visit>
requires std::is_same_v<std::remove_const_t<Node>, SimplifiedNode>
void for_each_array(Node& node, const Visit& visit) {
  visit(node.triangles);
  visit(node.corners);
  visit(node.added);
  visit(node.lost);
  visit(node.merges);
  visit(node.bare_targets);
  visit(node.grown);
  visit(node.vanished);
  visit(node.within.wedges);
  visit(node.within.indices);
  visit(node.within.splits);
}

template <typename Group, typename Visit>
requires std::is_same_v<std::remove_const_t<Group>, GroupInput>
void for_each_array(Group& group, const Visit& visit) {
  visit(group.mesh.positions);
  visit(group.mesh.normals);
  visit(group.mesh.colors);
  visit(group.mesh.texture_coordinates);
  visit(group.mesh.extra_wedges);
  visit(group.mesh.triangle_materials);
  visit(group.vertices);
  visit(group.wedges);
  visit(group.locked);
  visit(group.shared);
}

// An array of trivially copyable values without padding, after their number.
template <typename T>
void put_array(std::vector<std::byte>& to, const std::vector<T>& values) {
  put_bytes(to, bytes_of(static_cast<std::uint32_t>(values.size())));
  put_bytes(to, std::as_bytes(std::span(values)));
}

template <typename T>
void get_array(std::span<const std::byte>& from, std::vector<T>& values) {
  std::uint32_t size = 0;
  get_bytes(from, writable_bytes_of(size));
  values.resize(size);
  get_bytes(from, std::as_writable_bytes(std::span(values)));
}

template <typename Arrays>
void put_arrays(std::vector<std::byte>& to, const Arrays& of) {
  for_each_array(of, [&](const auto& values) { put_array(to, values); });
}

template <typename Arrays>
void get_arrays(std::span<const std::byte>& from, Arrays& of) {
  for_each_array(of, [&](auto& values) { get_array(from, values); });
}

inline void put_node(std::vector<std::byte>& to, const SimplifiedNode& node) {
  put_bytes(to, bytes_of(NodeFacts{node.box, node.error, node.guaranteed_error}));
  put_arrays(to, node);
}

inline void get_node(std::span<const std::byte>& from, SimplifiedNode& node) {
  NodeFacts facts;
  get_bytes(from, writable_bytes_of(facts));
  node.box = facts.box;
  node.error = facts.error;
  node.guaranteed_error = facts.guaranteed_error;
  get_arrays(from, node);
}

}  // namespace occlod::hlod
