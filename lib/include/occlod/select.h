// What to draw of HLODs in a view, for renderers that have no hlod::RenderDevice: nodes, and triangles of their meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/mat4x4.hpp>
#include <memory>
#include <span>
#include <vector>

#include "occlod/device.h"
#include "occlod/hlod.h"
#include "occlod/view.h"

namespace occlod::hlod {

// How nodes are selected.
struct SelectOptions {
  // Everything visible is off by at most so many pixels (Node::error), unless meshes or `budget` do not allow it; >= 0;
  // 0: the input itself.
  double tolerance_px = 1.0;
  // Triangles: the tolerance grows until so many do. Where it is too small for the roots, these are selected all the
  // same. 0: no limit.
  std::size_t budget = 0;
  // Leaves out what is hidden in a depth image of the view's size, drawn in software along with the selection. false:
  // only what is outside the frustum.
  bool occlusion = true;
  bool geomorph = false;  // fills DrawRange::morph: see TraverseOptions::geomorph
  // What would be seen if everything moved by so many pixels is not hidden either, >= 0: for renderers that draw a
  // selection some frames after it was asked for. Such renderers also give a view that is wider by as many.
  double slack_px = 0.0;
  int prefetch_frames = 15;  // of HLODs with a store: see TraverseOptions::prefetch_frames

  friend bool operator==(const SelectOptions&, const SelectOptions&) = default;
};

// Part of a node, to be drawn. A node with several parents may be selected twice, with other triangles.
struct SelectedNode {
  std::uint32_t object = 0;           // index into the objects
  NodeId node = 0;                    // of that object's HLOD
  NodeMesh mesh;                      // of the node: always the same, so it is uploaded once
  std::span<const DrawRange> ranges;  // of mesh.indices: at least one, ascending
};

// What to draw in a view. Spans live until the next select().
struct Selection {
  std::vector<SelectedNode> nodes;  // about from front to back
  std::size_t triangles = 0;        // of them
  double tolerance_px = 0.0;        // that they were selected by: SelectOptions::tolerance_px, or what the budget needs
  double largest_error_px = 0.0;    // of a node; larger than the tolerance only where meshes or the budget are too few
  std::size_t hidden = 0;           // nodes that were left out, with all that is below them
  std::size_t missing = 0;       // meshes that were not there, so that coarser ones are selected: NodeStore::missing()
  std::uint64_t front_hash = 0;  // Frame::front_hash: equal when the same patches are selected
};

// Selects from frame to frame, and remembers what was visible and which tolerance the budget needed. One thread at a
// time.
class Selector {
 public:
  // Selects from these objects, whose HLODs live as long as the selector. Throws Error as Traverser does.
  explicit Selector(std::span<const PlacedHlod> objects);
  Selector(Selector&&) noexcept;
  Selector& operator=(Selector&&) noexcept;
  ~Selector();

  // Moves an object; what is known of its visibility is kept. Throws Error as the constructor does, and for an index
  // out of range.
  void set_transform(std::size_t object, const glm::dmat4& object_to_world);

  // Returns what to draw in one frame, valid until the next call. Without gaps between nodes where their HLOD has none,
  // and with all that is visible at the middle of a pixel. What it shows depends on the view, the options and what is
  // loaded; how much of what is hidden it has, and the tolerance where there is a budget, also on earlier frames. Of an
  // HLOD with a store, coarser nodes take the place of those whose meshes are missing, which are loaded meanwhile.
  // Throws Error for options out of their range, for a view that is too far from an object, and for a damaged file.
  // O(nodes visited * log(nodes visited)), with occlusion also O(triangles selected + pixels covered); with a budget
  // also O(nodes), and up to some times all of that in the first frame and where something large comes into sight.
  const Selection& select(const View& view, const SelectOptions& options = {});

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod::hlod
