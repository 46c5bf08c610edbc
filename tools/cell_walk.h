// A walk through view cells along a camera path, frame by frame, with a disk that is simulated.
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
  // Loads take what this disk takes and the processor time that they need, of time that passes from frame to frame.
  // None: a disk that takes no time.
  std::optional<DiskSpeed> disk;
};

// What a frame took and shows. Times are of this thread's processor, but for drawing.
struct CellWalkFrame {
  Camera camera;
  WalkedFrame walked;              // without objects
  std::size_t view_triangles = 0;  // drawn: of the cell, in blocks that may be in the frustum
  double step_ms = 0.0;            // CellWalker::step()
  double cull_ms = 0.0;            // ranges_in_view()
  double draw_ms = 0.0;            // draw_items(), wall time
  double load_ms = 0.0;            // of loads that ended since the frame before
  std::uint64_t hash = 0;          // hash_of() what is drawn for the cell
};

// Of the triangles that are drawn, whatever their order: the sum, modulo 2^64, over all of h ^ h >> 32, where h begins
// with 14695981039346656037 + the number of the object, and for each bit pattern of the nine coordinates becomes
// (h ^ bits) * 1099511628211.
[[nodiscard]] std::uint64_t hash_of(const WalkedFrame& frame);

class CellWalk {
 public:
  // Objects and file outlive it. No objects: through a packed file.
  CellWalk(std::shared_ptr<const VlodFile> file, std::span<const RefineObject> objects, const CellWalkOptions& options);

  // Goes on by one frame: step, cull, draw; then loads run for as long as a frame lasts.
  const CellWalkFrame& go_to(const Camera& camera);
  // The same without drawing.
  const WalkedFrame& step_to(const Camera& camera);
  // Frames without drawing that last for so many seconds.
  void stand(const Camera& camera, double seconds);

  // What the last frame or step gave, with its objects; valid until the next one.
  [[nodiscard]] const WalkedFrame& walked() const { return *walked_; }
  // What the last frame has drawn.
  [[nodiscard]] const ItemBuffer& items() const { return items_; }
  [[nodiscard]] std::span<const DrawObject> drawn() const { return drawn_; }
  // And of which objects: one for each of drawn().
  [[nodiscard]] std::span<const ObjectRange> ranges() const { return ranges_; }

 private:
  void run_loads();

  std::shared_ptr<const VlodFile> file_;
  std::vector<RefineObject> objects_;
  bool takes_time_ = false;              // loading
  double disk_clock_ = 0.0, now_ = 0.0;  // seconds: when the disk is done with what it does, and of the walk
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

// How far a picture is from that of the full mesh, which it draws itself.
class WalkReference {
 public:
  explicit WalkReference(std::span<const RefineObject> objects) : full_(objects) {}

  struct Distance {
    std::size_t unexplained_px = 0;  // see count_unexplained_pixels()
    double depth_rms_px = 0.0;       // see PictureDistance
  };
  void set_view(const View& view);
  // `allowed_px`: how far anything may be.
  [[nodiscard]] Distance compare(const View& view, const DepthBuffer& depth, double allowed_px) const;
  [[nodiscard]] const FullScene& full() const { return full_; }

 private:
  FullScene full_;
  ItemBuffer items_;
};

}  // namespace occlod::tool
