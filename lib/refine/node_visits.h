// What nodes of the forest have to offer when refinement comes to them: their own splits, and their children.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

#include "refine/importance.h"
#include "refine/star_visibility.h"
#include "refine/entry_queries.h"
#include "refine/refined_scene.h"

namespace occlod {

// Many nodes at once, in pieces that one or two threads work on. Whether nodes are seen and what they have to offer
// depends on hierarchies, views and the occluder alone, on nothing that refinement does meanwhile. Reuses its memory.
class NodeVisits {
 public:
  struct Child {
    SplitId split = no_id;  // no_id: there is none
    float scale_px = 0.0F;  // what weigh_splits() tells
    ScreenError error;
  };
  struct Found {
    Importance::Value value;  // of the split itself, with Culling::star
    std::array<Child, 2> children;
  };
  struct Piece {
    std::vector<Entry> visits;  // that are not hidden
    std::vector<Found> found;   // of each of them
    EntryQueries::Questions questions;
    bool by_caller = false;  // and not by the other thread
  };

  // All of them outlive the work. `visits`: those of one object should be side by side.
  void begin(const RefinedScene& scene, const EntryQueries& entries, std::span<const Entry> visits);
  [[nodiscard]] std::size_t piece_count() const noexcept { return piece_count_; }
  // Works on pieces until all are done or under way. Throws Error when a node is damaged or is not where its parent
  // says.
  void work_as_caller() { work(0); }
  void work_beside() { work(1); }
  // No other piece is begun.
  void end() noexcept { next_ = piece_count_; }
  // When all are done.
  [[nodiscard]] std::span<const Piece> pieces() const noexcept { return std::span(pieces_).first(piece_count_); }

 private:
  // Of a thread.
  struct Scratch {
    StarVisibility star_visibility;
    std::vector<SplitId> splits, children;  // of one object; children of an entry at twice its place
    std::vector<StarView> stars;
    std::vector<float> scales_px;
  };
  void work(std::size_t thread);
  void evaluate(Piece& piece, Scratch& scratch) const;
  void evaluate_object(std::span<const Entry> visits, std::span<Found> found, Scratch& scratch) const;

  RefinedScene scene_;
  const EntryQueries* entries_ = nullptr;
  std::vector<Piece> pieces_;
  std::size_t piece_count_ = 0;
  std::atomic<std::size_t> next_ = 0;
  std::array<Scratch, 2> scratch_;
};

}  // namespace occlod
