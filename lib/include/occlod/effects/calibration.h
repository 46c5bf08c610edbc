// What the parts of a frame cost on one machine, measured once: after Guthe, Balazs and Klein, "Near Optimal
// Hierarchical Culling: Performance Driven Use of Hardware Occlusion Queries" (2006), sec. 3.2, with the cost of
// refinement added.
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "occlod/device/device_costs.h"
#include "occlod/refine/visibility.h"

namespace occlod {

// Costs of one backend. Nanoseconds, finite, all > 0.
struct BackendCosts {
  std::string name;                   // Visibility::name()
  double occluder_triangle_ns = 0.0;  // for each triangle of an occluder
  double occluder_fragment_ns = 0.0;  // for each fragment of an occluder
  double occluder_pixel_ns = 0.0;     // for each pixel of the image and each occluder: cleared and reduced
  double query_ns = 0.0;              // for one of many queries, including what refinement does for it
  double latency_ns = 0.0;            // for one query that is waited for

  friend bool operator==(const BackendCosts&, const BackendCosts&) = default;
};

// Costs of refinement and drawing. Nanoseconds, finite, all > 0.
struct Calibration {
  double visit_ns = 0.0;       // refinement visits a node that is in the processor's caches
  double far_visit_ns = 0.0;   // refinement visits a node that is not
  double cone_ns = 0.0;        // a visit tests the normal cone too
  double split_ns = 0.0;       // a split is applied: two triangles
  double kept_split_ns = 0.0;  // frame to frame: an applied split is evaluated again
  double triangle_ns = 0.0;    // drawing one triangle into the item buffer; a program that draws otherwise sets its own
  double fragment_ns = 0.0;    // drawing one fragment, likewise
  std::vector<BackendCosts> backends;  // one for each name
  // Of what HLODs are drawn with, by hlod::measure_costs(); one for each name. Times >= 0. measure_calibration() leaves
  // it empty, and files may leave it out.
  std::vector<hlod::DeviceCosts> devices = {};

  friend bool operator==(const Calibration&, const Calibration&) = default;
};

// Measures refinement, drawing and each backend (none null) on a generated mesh, each number as the median of a few
// passes: some 150 ms on the CPU. Throws what a backend throws.
[[nodiscard]] Calibration measure_calibration(std::span<const std::unique_ptr<Visibility>> backends);

// The costs of the device with this name. Throws Error that lists the names.
[[nodiscard]] const hlod::DeviceCosts& device_costs_of(const Calibration& calibration, std::string_view device);

// Throws Error that names the first number that is not finite or not larger than 0; of devices, below 0.
void check_calibration(const Calibration& calibration);

// As JSON, with every digit, so that reading gives the same calibration back.
[[nodiscard]] std::string calibration_json(const Calibration& calibration);
// From such a file. Throws Error that names the file and the JSON path of what is missing, unknown, repeated, no number
// or not positive.
[[nodiscard]] Calibration read_calibration(const std::filesystem::path& path);
// To such a file, beside `path` and renamed. Throws Error that names the file.
void write_calibration(const std::filesystem::path& path, const Calibration& calibration);

}  // namespace occlod
