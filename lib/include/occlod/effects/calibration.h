// What one machine's parts of a frame cost, measured once: after Guthe, Balazs and Klein, "Near Optimal Hierarchical
// Culling", sec. 3.2, for triangles that also have to be found.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "occlod/refine/visibility.h"

namespace occlod {

// Nanoseconds, all > 0.
struct BackendCosts {
  std::string name;                   // Visibility::name()
  double occluder_triangle_ns = 0.0;  // drawn into the occluder
  double occluder_pixel_ns = 0.0;     // of the image, for each occluder: emptied, filled, reduced
  double query_ns = 0.0;              // one of many questions, with what refinement does for it
  double latency_ns = 0.0;            // one question that is waited for

  friend bool operator==(const BackendCosts&, const BackendCosts&) = default;
};

// Nanoseconds, all > 0.
struct Calibration {
  double visit_ns = 0.0;       // refinement looks at a node that is in the caches
  double far_visit_ns = 0.0;   // and at one that is not
  double cone_ns = 0.0;        // and at its normal cone
  double split_ns = 0.0;       // and applies it: two triangles
  double kept_split_ns = 0.0;  // refinement that goes on from the frame before weighs a split that it has
  double triangle_ns = 0.0;    // drawn: of the item buffer; a program that draws by other means puts its own here
  double fragment_ns = 0.0;    // drawn, likewise
  std::vector<BackendCosts> backends;

  friend bool operator==(const Calibration&, const Calibration&) = default;
};

// Measures on a generated mesh, the fastest of a few rounds: some 40 ms on the CPU.
[[nodiscard]] Calibration measure_calibration(std::span<const std::unique_ptr<Visibility>> backends);

// As JSON, with every digit, so that the same calibration comes back.
[[nodiscard]] std::string calibration_json(const Calibration& calibration);
// The same in a file. Both throw Error that names the file and the place: what is missing, unknown, no number or not
// positive.
[[nodiscard]] Calibration read_calibration(const std::filesystem::path& path);
void write_calibration(const std::filesystem::path& path, const Calibration& calibration);

}  // namespace occlod
