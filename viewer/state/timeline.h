// Records the cost and the result of every picture.
#pragma once

#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>

#include "occlod/cell_walker.h"
#include "occlod/device.h"
#include "occlod/traverser.h"

namespace occlod::viewer {

// Holds the cost of a picture whose mesh was there.
struct PictureCost {
  double upload_ms = 0.0;
  std::size_t uploaded_bytes = 0;  // of triangles, colours and vertices
  double draw_ms = 0.0;
};

struct PictureRecord {
  std::uint64_t picture = 0;  // ascending
  double at_s = 0.0;          // since the session began
  int path_frame = -1;        // of the camera path that is played
  // The next five are 0 when the mesh of the previous picture was drawn again.
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
  double max_error_px = 0.0;  // a guaranteed bound, often many times the true error; of an HLOD its nodes' error
  double max_quadric_error_px = 0.0;  // the same of the quadric error, about the root mean square; 0 where only the
                                      // other is known: of HLODs and cells
  double memory_mb = 0.0;
  std::uint64_t hash = 0;  // of the refinement, or of the front
  // These are 0 unless HLODs are drawn. Then refine_ms is the frame without stalls, occlusion_ms the stalls.
  hlod::FrameStats hlod;
  hlod::FrameTimes times;
  // This is empty unless view cells are drawn.
  std::optional<WalkedFrame> walked;  // without objects

  [[nodiscard]] double total_ms() const { return refine_ms + occlusion_ms + cost.upload_ms + cost.draw_ms; }
};

class Timeline {
 public:
  // Keeps the last `capacity` records.
  void add(const PictureRecord& record);
  [[nodiscard]] const std::deque<PictureRecord>& records() const noexcept { return records_; }
  void clear() { records_.clear(); }
  // Writes one line per picture, names of columns first. Throws Error.
  void write_csv(const std::filesystem::path& file) const;

  static constexpr std::size_t capacity = 10'000;

 private:
  std::deque<PictureRecord> records_;
};

// Returns the first of 1, 2, 5, 10, ... times `least` that is not below `value`; `least` if that is not finite.
[[nodiscard]] double round_up(double value, double least);

// Returns the scale of a graph that contains nearly all records from the `first` on, which exists.
[[nodiscard]] double graph_top_ms(const std::deque<PictureRecord>& records, std::size_t first);

// Returns the memory of this process in MB; 0 if the system does not tell.
[[nodiscard]] double resident_memory_mb();

}  // namespace occlod::viewer
