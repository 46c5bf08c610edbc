// The device `virtual`: the answers of `software` under a simulated clock, so that frame times can be repeated.
#pragma once

#include <memory>

#include "occlod/device/device.h"
#include "occlod/device/device_costs.h"
#include "occlod/device/software_device.h"

namespace occlod::hlod {

// Two clocks start each frame at 0: c of the calling thread, g of the device. A command adds submit_ns to c; it starts
// on the device at max(c, g), takes what DeviceCosts says with the fragments that it really has, and g is then its end.
// A visit adds visit_ns to c. An answer can be read readback_ns after its query has ended: available() compares that
// with c, wait() sets c to it if it is later, and the difference is stall. Boxes that count all or no pixels without
// being drawn (RenderDevice::ask) cost nothing; a query of nothing else can be read at once. Gaps of g between commands
// are starvation; the frame ends at max(c, g). So times are the same on every machine.
class VirtualDevice final : public RenderDevice {
 public:
  // Throws Error for a cost that is negative or not finite.
  explicit VirtualDevice(DeviceCosts costs, const SoftwareDeviceOptions& options = {});
  ~VirtualDevice() override;

  // "virtual:" and the name of the costs.
  [[nodiscard]] std::string_view name() const noexcept override;
  void begin_frame(const View& view, std::span<const PlacedHlod> objects) override;
  void draw(const NodeDraw& draw) override;
  [[nodiscard]] QueryId ask(std::span<const BoxRef> boxes) override;
  [[nodiscard]] QueryId ask_each(std::span<const BoxRef> boxes) override;
  [[nodiscard]] bool available(QueryId query) override;
  [[nodiscard]] std::span<const std::uint32_t> wait(QueryId query) override;
  void visit(std::size_t nodes) override;
  FrameTimes end_frame() override;

  // What draws and counts: its picture and its work.
  [[nodiscard]] const SoftwareDevice& software() const noexcept;
  // As given.
  [[nodiscard]] const DeviceCosts& costs() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod::hlod
