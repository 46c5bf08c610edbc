// Writes the records that SplitStar reads, and checks those of unknown origin.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "occlod/core/ids.h"
#include "occlod/hierarchy/split_star.h"
#include "occlod/mesh/triangle_mesh.h"
#include "splits/star_shape.h"

namespace occlod {

struct RemovedFace {
  FaceRef ref;
  Triangle corners;
};

// What a record says. The inserted faces of a fan are in ring order, each with v as its first corner.
struct StarContents {
  VertexId u = no_id;
  StarShape shape = StarShape::other;
  std::span<const Triangle> inserted;
  std::span<RemovedFace> removed;         // put into order when they are those that a fan implies
  std::span<const SplitId> dependencies;  // ascending
};

// Appends the shortest record that holds the star.
void append_star(const StarContents& star, std::vector<std::uint32_t>& words);

// A closed fan of which every removed face is known: those without the parent vertex, in the order of its slots.
struct FanContents {
  std::span<const VertexId> ring;
  std::size_t parent_place = 0;
  std::span<const FaceRef> removed;
};

// Likewise; returns whether it did. Nothing is appended when the star needs more than a short record holds.
[[nodiscard]] bool append_fan(const FanContents& fan, std::vector<std::uint32_t>& words);

// Whether record and its ids can be read safely: it ends where the next begins, corners are vertices that are there
// once split s is applied (smaller than or equal to its own), dependencies and the splits of removed faces are smaller
// than s. Returns what is wrong, or nothing.
[[nodiscard]] std::optional<std::string> check_star(std::span<const std::uint32_t> record, SplitId s, VertexId vertex,
                                                    std::size_t base_faces);

}  // namespace occlod
