// Measures what the commands of a device cost: Guthe, Balazs and Klein 2006, sec. 3.2.2.
#pragma once

#include "occlod/device/device.h"
#include "occlod/device/device_costs.h"

namespace occlod::hlod {

// Draws a mesh of 64,800 triangles and one of two, a pixel large or filling an image of 512 x 512, and asks about boxes
// of both sizes, in frames of few and of many commands; what the latter take more, by FrameTimes::frame_ms, is what the
// commands cost. Medians of nine rounds, at least 0.001 ns; of 1,000 single queries that are waited for, on an empty
// pipeline, what is left after the slowest thousandth has been dropped gives readback_ns. submit_ns and visit_ns come
// from FrameTimes::cpu_ms. latency_commands, which nothing tells, is 0. About a second; exact on simulated devices.
// Throws what the device throws.
[[nodiscard]] DeviceCosts measure_costs(RenderDevice& device);

}  // namespace occlod::hlod
