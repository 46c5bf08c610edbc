// How good simplified textured meshes are.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "occlod/mesh.h"
#include "wedges/simplifiers.h"

namespace occlod::bench {

// One result. Lengths in percent of the input's diagonal.
struct WedgeRow {
  std::string mesh;
  std::string tool;
  std::string variant;
  std::size_t target = 0;     // triangles asked for
  std::size_t triangles = 0;  // got: more than asked for where the tool is stuck
  double geometry_rms_pct = 0.0;
  double geometry_max_pct = 0.0;
  std::optional<double> slip_rms_pct;     // none without texture coordinates
  std::optional<double> slip_max_pct;     // likewise
  std::optional<double> slip_lost_pct;    // of the samples
  std::optional<double> psnr_checker_db;  // luma, over all views; infinite when equal
  std::optional<double> psnr_image_db;    // none where the mesh has no image
  double milliseconds = 0.0;              // median
  double bytes_per_vertex = 0.0;
  std::uint64_t hash = 0;  // of the result: positions, texture coordinates and triangles
};

struct ScoreOptions {
  std::size_t samples = 100'000;  // points on each surface
  int size_px = 512;              // of the pictures, squares
};

// Compares results with one input. Keeps views of it.
class WedgeScorer {
 public:
  // folder: of the mesh's images.
  WedgeScorer(const TriangleMesh& input, const std::string& folder, const ScoreOptions& options);
  ~WedgeScorer();
  WedgeScorer(const WedgeScorer&) = delete;
  WedgeScorer& operator=(const WedgeScorer&) = delete;

  // Fills what is measured. Pictures take the most time.
  void score(WedgeRow& row, const WedgeRun& run, bool with_pictures) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace occlod::bench
