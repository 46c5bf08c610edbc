// Walks through view cells along a camera path, frame by frame, with a simulated disk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "full_scene.h"
#include "occlod/cell_walker.h"
#include "occlod/item_buffer.h"
#include "occlod/picture.h"
#include "occlod/refiner.h"
#include "occlod/scene.h"
#include "occlod/view.h"
#include "simulated_disk.h"

namespace occlod::tool {

inline constexpr double walk_frame_seconds = 1.0 / 60.0;  // from one frame of a path to the next

struct CellWalkOptions {
  std::size_t memory = WalkOptions().memory;
  bool prefetch = true;
  // Loads take the time of this disk plus their processor time, while time passes from frame to frame. Without a value
  // the disk takes no time.
  std::optional<DiskSpeed> disk;
};

// Describes what a frame cost and shows. Times are processor times of this thread, except for drawing.
struct CellWalkFrame {
  Camera camera;
  WalkedFrame walked;              // without objects
  std::size_t view_triangles = 0;  // drawn, of the cell, in blocks that may be in the frustum
  double step_ms = 0.0;            // CellWalker::step()
  double cull_ms = 0.0;            // ranges_in_view()
  double draw_ms = 0.0;            // draw_items(), wall time
  double load_ms = 0.0;            // of loads that ended since the previous frame
  std::uint64_t hash = 0;          // hash_of() what is drawn for the cell
};

// Returns a hash of the drawn triangles, whatever their order: the sum, modulo 2^64, of h ^ h >> 32 over all triangles,
// where h starts as 14695981039346656037 + the number of the object, and becomes (h ^ bits) * 1099511628211 for each
// bit pattern of the nine coordinates.
[[nodiscard]] std::uint64_t hash_of(const WalkedFrame& frame);

class CellWalk {
 public:
  // Objects and file must outlive it. Without objects the file must be packed.
  CellWalk(std::shared_ptr<const VlodFile> file, std::span<const RefineObject> objects, const CellWalkOptions& options);

  // Advances by one frame: step, cull, draw; then loads run for the duration of a frame.
  const CellWalkFrame& go_to(const Camera& camera);
  // Advances by one frame without drawing.
  const WalkedFrame& step_to(const Camera& camera);
  // Runs frames without drawing for this many seconds.
  void stand(const Camera& camera, double seconds);

  // Returns what the last frame or step gave, with its objects; valid until the next one.
  [[nodiscard]] const WalkedFrame& walked() const { return *walked_; }
  // Returns what the last frame drew.
  [[nodiscard]] const ItemBuffer& items() const { return items_; }
  [[nodiscard]] std::span<const DrawObject> drawn() const { return drawn_; }
  // Returns the range of an object for each entry of drawn().
  [[nodiscard]] std::span<const ObjectRange> ranges() const { return ranges_; }

 private:
  void run_loads();

  std::shared_ptr<const VlodFile> file_;
  std::vector<RefineObject> objects_;
  bool takes_time_ = false;              // whether loading does
  double disk_clock_ = 0.0, now_ = 0.0;  // seconds: when the disk becomes idle, and the time of the walk
  double load_ms_ = 0.0;                 // since the last frame
  bool under_way_ = false;
  std::optional<CellWalker> walker_;
  std::optional<CellLoader> loader_;
  std::vector<ObjectRange> ranges_;
  std::vector<DrawObject> drawn_;
  ItemBuffer items_;
  CellWalkFrame frame_;
  WalkedFrame stepped_;                  // without objects
  const WalkedFrame* walked_ = nullptr;  // the walker's
};

// Compares pictures with those of the full mesh, which it draws itself.
class WalkReference {
 public:
  explicit WalkReference(std::span<const RefineObject> objects) : full_(objects) {}

  struct Distance {
    std::size_t unexplained_px = 0;  // see count_unexplained_pixels()
    double depth_rms_px = 0.0;       // see PictureDistance
  };
  void set_view(const View& view);
  // `allowed_px` is the error that is allowed everywhere.
  [[nodiscard]] Distance compare(const View& view, const DepthBuffer& depth, double allowed_px) const;
  [[nodiscard]] const FullScene& full() const { return full_; }

 private:
  FullScene full_;
  ItemBuffer items_;
};

}  // namespace occlod::tool
