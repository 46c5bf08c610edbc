// What the commands of a device cost: the characteristic times of Guthe and others 2006 (sec. 3.2), and what commands
// cost the processor that gives them.
#pragma once

#include <cstdint>
#include <string>

namespace occlod::hlod {

// Times in ns, finite and >= 0. The stages of the device work side by side, so the slowest decides:
//   draw:  max(draw_ns, triangles * triangle_ns, fragments * fragment_ns)
//   query: max(query_ns, 12 * boxes * triangle_ns, fragments of the boxes * query_fragment_ns)
//   batch: max(batch_ns + boxes * batch_item_ns, fragments of the boxes * query_fragment_ns)
// Fragments are pixels that triangles or boxes cover, whether they pass the depth test or not.
struct DeviceCosts {
  std::string name = {};           // of a preset, or any
  double draw_ns = 0.0;            // T_r^s: set-up of a draw
  double triangle_ns = 0.0;        // T_r^D
  double fragment_ns = 0.0;        // T_r^f: of a draw
  double query_ns = 0.0;           // T_o^s: set-up of a query, its few triangles included
  double query_fragment_ns = 0.0;  // T_o^f
  double wrapped_query_ns = 0.0;   // T_o^o: what a query beside a draw adds to the draw
  double readback_ns = 0.0;  // from the end of a query on the device until it can be read: T_o^l without the query
  std::uint32_t latency_commands = 0;  // nor is it available before so many commands have followed; wait() need not
                                       // wait for them
  double batch_ns = 0.0;               // of RenderDevice::ask_each(): set-up
  double batch_item_ns = 0.0;          // of each box in it
  double submit_ns = 0.0;              // of the processor: giving one command
  double visit_ns = 0.0;               // of the processor: looking at one node

  friend bool operator==(const DeviceCosts&, const DeviceCosts&) = default;
};

// Throws Error for a cost that is negative or not finite. `subject` says in errors what has these costs.
void check_device_costs(const char* subject, const DeviceCosts& costs);

}  // namespace occlod::hlod
