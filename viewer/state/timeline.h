// What every picture took and what came of it.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>

#include "occlod/cell_walker.h"
#include "occlod/device.h"
#include "occlod/traverser.h"

namespace occlod::viewer {

// Of a picture whose mesh was there.
struct PictureCost {
  double upload_ms = 0.0;
  std::size_t uploaded_bytes = 0;  // of triangles, colours and vertices
  double draw_ms = 0.0;
};

struct PictureRecord {
  std::uint64_t picture = 0;  // ascending
  int path_frame = -1;        // of the camera path that is played
  // All 0 when the mesh of the picture before was drawn again.
  double refine_ms = 0.0;
  double occlusion_ms = 0.0;
  std::size_t new_splits = 0;
  std::size_t merged_splits = 0;
  std::size_t changed_triangles = 0;
  bool pending = false;  // a limit has left work over
  PictureCost cost;
  std::size_t budget = 0;
  std::size_t triangles = 0;
  std::size_t visible_triangles = 0;  // 0 when they are not counted
  std::size_t splits = 0;
  std::size_t forced_splits = 0;
  std::size_t queries = 0;
  std::size_t queries_hidden = 0;
  double max_error_px = 0.0;
  double memory_mb = 0.0;
  std::uint64_t hash = 0;  // of the refinement, or of the front
  // Of HLODs; else all 0. refine_ms is then the frame without stalls, occlusion_ms the stalls.
  hlod::FrameStats hlod;
  hlod::FrameTimes times;
  // Of view cells; else none.
  std::optional<WalkedFrame> walked;  // without objects

  [[nodiscard]] double total_ms() const { return refine_ms + occlusion_ms + cost.upload_ms + cost.draw_ms; }
};

class Timeline {
 public:
  // Keeps the last `capacity`.
  void add(const PictureRecord& record);
  [[nodiscard]] const std::deque<PictureRecord>& records() const noexcept { return records_; }
  void clear() { records_.clear(); }
  // One line a picture, names of columns first. Throws Error.
  void write_csv(const std::filesystem::path& file) const;

  static constexpr std::size_t capacity = 10'000;

 private:
  std::deque<PictureRecord> records_;
};

// Of this process, in MB; 0 where the system does not say.
[[nodiscard]] double resident_memory_mb();

}  // namespace occlod::viewer
