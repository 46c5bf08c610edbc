#include "hlod/build/parts.h"

#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <optional>
#include <utility>

#include "base/atomic_file.h"
#include "base/file_input.h"
#include "base/memory.h"
#include "base/threads.h"
#include "hlod/build/build_bytes.h"
#include "hlod/hlod_builder_id.h"
#include "occlod/base.h"
#include "occlod/build_hlod.h"

namespace occlod::hlod {
namespace {

using Magic = std::array<char, 8>;
constexpr Magic task_magic = {'O', 'C', 'C', 'L', 'O', 'D', 'H', 'T'};
constexpr Magic result_magic = {'O', 'C', 'C', 'L', 'O', 'D', 'H', 'N'};

// Precedes what a file holds.
struct PartHead {
  Magic magic{};
  std::array<char, 64> builder{};  // hash of all sources that decide what nodes hold
  std::uint64_t task = 0;          // XXH3-64 of what follows the head of the task
  std::uint64_t body = 0;          // XXH3-64 of what follows this head
};
static_assert(sizeof(PartHead) == 88);

std::uint64_t checksum_of(std::span<const std::byte> body) { return XXH3_64bits(body.data(), body.size()); }

// Fills in the head of `bytes`, whose body is complete. Returns the checksum of the body.
std::uint64_t seal(std::vector<std::byte>& bytes, const Magic& magic, std::optional<std::uint64_t> task) {
  PartHead head;
  head.magic = magic;
  static_assert(sizeof(hlod_builder_id) == sizeof(head.builder) + 1);
  std::copy_n(hlod_builder_id, head.builder.size(), head.builder.begin());
  head.body = checksum_of(std::span<const std::byte>(bytes).subspan(sizeof(head)));
  head.task = task.value_or(head.body);
  std::memcpy(bytes.data(), &head, sizeof(head));
  return head.body;
}

// Returns the head of a file of this version that is whole.
std::optional<PartHead> head_of(std::span<const std::byte> bytes, const Magic& magic) {
  PartHead head;
  if (bytes.size() < sizeof(head)) return std::nullopt;
  std::memcpy(&head, bytes.data(), sizeof(head));
  if (head.magic != magic || !std::equal(head.builder.begin(), head.builder.end(), hlod_builder_id))
    return std::nullopt;
  if (head.body != checksum_of(bytes.subspan(sizeof(head)))) return std::nullopt;
  return head;
}

void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

// Triangles of a group: it has fewer than 2^16 wedges, as the largest groups have 5 * 4096 triangles.
struct ShortTriangle {
  std::uint16_t x = 0, y = 0, z = 0;
};

void put_triangles(std::vector<std::byte>& to, const std::vector<Triangle>& triangles) {
  std::vector<ShortTriangle> all;
  all.reserve(triangles.size());
  const auto short_id = [](std::uint32_t id) {
    assert(id <= 0xffff);
    return static_cast<std::uint16_t>(id);
  };
  for (const Triangle& t : triangles) all.push_back({short_id(t.x), short_id(t.y), short_id(t.z)});
  put_array(to, all);
}

void get_triangles(std::span<const std::byte>& from, std::vector<Triangle>& triangles) {
  std::vector<ShortTriangle> all;
  get_array(from, all);
  triangles.reserve(all.size());
  for (const ShortTriangle& t : all) triangles.emplace_back(t.x, t.y, t.z);
}

// Boxes of the input's vertices are these, and are left out.
std::vector<Box> boxes_of_positions(const GroupInput& group) {
  std::vector<Box> boxes;
  for (std::size_t v = 0; v < group.vertices.size(); ++v)
    boxes.push_back({group.mesh.positions[v], group.mesh.positions[v]});
  return boxes;
}

void put_group(std::vector<std::byte>& to, const GroupInput& group) {
  put_triangles(to, group.mesh.triangles);
  put_triangles(to, group.mesh.corners);
  put_arrays(to, group);
  const std::vector<Box> of_positions = boxes_of_positions(group);
  const bool are_left_out =
      std::ranges::equal(std::as_bytes(std::span(group.boxes)), std::as_bytes(std::span(of_positions)));
  put_array(to, are_left_out ? std::vector<Box>() : group.boxes);
}

void get_group(std::span<const std::byte>& from, GroupInput& group) {
  get_triangles(from, group.mesh.triangles);
  get_triangles(from, group.mesh.corners);
  get_arrays(from, group);
  get_array(from, group.boxes);
  if (group.boxes.empty()) group.boxes = boxes_of_positions(group);
}

// Reads the groups of a task.
std::vector<GroupInput> unpack_task(std::span<const std::byte> body, GroupRules& rules) {
  std::uint32_t count = 0;
  get_bytes(body, writable_bytes_of(rules));
  get_bytes(body, writable_bytes_of(count));
  std::vector<GroupInput> groups(count);
  for (GroupInput& group : groups) get_group(body, group);
  return groups;
}

}  // namespace

PartTask pack_task(const GroupRules& rules, std::span<const GroupInput> groups) {
  PartTask task;
  task.bytes.resize(sizeof(PartHead));
  put_bytes(task.bytes, bytes_of(rules));
  put_bytes(task.bytes, bytes_of(static_cast<std::uint32_t>(groups.size())));
  for (const GroupInput& group : groups) put_group(task.bytes, group);
  task.checksum = seal(task.bytes, task_magic, std::nullopt);
  return task;
}

void write_task(const std::filesystem::path& path, const PartTask& task) { write_file(path, task.bytes); }

std::filesystem::path result_of(std::filesystem::path task) { return task.replace_extension(result_extension); }

bool read_result(const std::filesystem::path& result, std::uint64_t task_checksum, std::span<SimplifiedNode> nodes) {
  if (!std::filesystem::exists(result)) return false;
  const LargeVector<std::byte> bytes = read_whole(result);
  const std::optional<PartHead> head = head_of(bytes, result_magic);
  if (!head || head->task != task_checksum) return false;
  std::span<const std::byte> body = std::span<const std::byte>(bytes).subspan(sizeof(PartHead));
  for (SimplifiedNode& node : nodes) get_node(body, node);
  return true;
}

void simplify_part(const std::filesystem::path& task, int threads) {
  const LargeVector<std::byte> read = read_whole(task);
  const std::optional<PartHead> head = head_of(read, task_magic);
  if (!head)
    throw Error({task.string(), "", "is no undamaged task of an HLOD build of this version of occlod",
                 "use the same version on all machines"});
  GroupRules rules;
  const std::vector<GroupInput> groups = unpack_task(std::span<const std::byte>(read).subspan(sizeof(PartHead)), rules);
  std::vector<SimplifiedNode> nodes(groups.size());
  const std::filesystem::path result = result_of(task);
  if (read_result(result, head->task, nodes)) return;
  for_each_task(
      groups.size(), thread_count(threads), [] { return GroupSimplifier(); },
      [&](GroupSimplifier& simplifier, std::size_t i) { nodes[i] = simplifier.run(groups[i], rules); }, [] {});
  std::vector<std::byte> bytes(sizeof(PartHead));
  for (const SimplifiedNode& node : nodes) put_node(bytes, node);
  seal(bytes, result_magic, head->task);
  write_file(result, bytes);
}

}  // namespace occlod::hlod
