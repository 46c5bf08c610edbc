// Costs of a device's commands: the characteristic times of Guthe and others 2006 (sec. 3.2), and the time that the
// processor spends to give commands.
#pragma once

#include <cstdint>
#include <string>

namespace occlod::hlod {

// Times in ns, finite and >= 0. The stages of the device work in parallel, so the slowest decides:
//   draw:  max(draw_ns, triangles * triangle_ns, fragments * fragment_ns)
//   query: max(query_ns, 12 * boxes * triangle_ns, fragments of the boxes * query_fragment_ns)
//   batch: max(batch_ns + boxes * batch_item_ns, fragments of the boxes * query_fragment_ns)
// Fragments are pixels that triangles or boxes cover, whether they pass the depth test or not.
struct DeviceCosts {
  std::string name = {};           // name of a preset, or any other
  double draw_ns = 0.0;            // T_r^s: set-up of a draw
  double triangle_ns = 0.0;        // T_r^D
  double fragment_ns = 0.0;        // T_r^f: one fragment of a draw
  double query_ns = 0.0;           // T_o^s: set-up of a query, including its few triangles
  double query_fragment_ns = 0.0;  // T_o^f: one fragment of a query
  double wrapped_query_ns = 0.0;   // T_o^o: what a query beside a draw adds to the draw
  double readback_ns = 0.0;  // from the end of a query on the device until its result can be read: T_o^l without the
                             // query
  std::uint32_t latency_commands = 0;  // a result is also not available before this many commands have followed; wait()
                                       // need not wait for them
  double batch_ns = 0.0;               // RenderDevice::ask_each(): set-up of a batch of queries
  double batch_item_ns = 0.0;          // RenderDevice::ask_each(): each box of a batch
  double submit_ns = 0.0;              // processor: giving one command
  double visit_ns = 0.0;               // processor: examining one node

  friend bool operator==(const DeviceCosts&, const DeviceCosts&) = default;
};

// Throws Error for a cost that is negative or not finite. `subject` says in errors what has these costs.
void check_device_costs(const char* subject, const DeviceCosts& costs);

}  // namespace occlod::hlod
