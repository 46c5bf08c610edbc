// A collapse sequence read face by face: which collapse made each, which ended it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "splits/simplify.h"

namespace occlod {

using CollapseIndex = CollapseId;  // into CollapseSequence::collapses
using FaceId = std::uint32_t;      // of LevelFaces

// Numbers all faces that ever existed: those that ended, in their order, then those of the base mesh. Keeps a view of
// the sequence.
class LevelFaces {
 public:
  explicit LevelFaces(const CollapseSequence& sequence);

  [[nodiscard]] CollapseIndex collapse_count() const noexcept {
    return static_cast<CollapseIndex>(sequence_.collapses.size());
  }
  [[nodiscard]] const Collapse& collapse(CollapseIndex c) const noexcept { return *sequence_.collapses[c]; }

  [[nodiscard]] FaceId face_count() const noexcept { return static_cast<FaceId>(faces_.size()); }
  [[nodiscard]] const Triangle& corners(FaceId f) const noexcept { return faces_[f].corners; }
  // The collapse that made the face; no_id for faces of the input.
  [[nodiscard]] CollapseIndex maker(FaceId f) const noexcept { return faces_[f].made_by; }
  // The faces that collapse c ended: [first_ended(c), first_ended(c + 1)).
  [[nodiscard]] FaceId first_ended(CollapseIndex c) const noexcept { return first_ended_[c]; }
  [[nodiscard]] std::span<const FaceId> made(CollapseIndex c) const noexcept {
    return {made_.data() + first_made_[c], first_made_[c + 1] - first_made_[c]};
  }

 private:
  void list_ended();
  void find_makers();

  const CollapseSequence& sequence_;
  std::vector<LevelFace> faces_;  // made by places
  std::vector<FaceId> first_ended_;
  std::vector<std::uint32_t> first_made_;
  std::vector<FaceId> made_;
};

}  // namespace occlod
