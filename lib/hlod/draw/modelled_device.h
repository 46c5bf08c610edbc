// Adds up what a frame would take by calibrated costs, while it is drawn.
#pragma once

#include <vector>

#include "hlod/draw/virtual_clock.h"
#include "hlod/draw/frame_scene.h"

namespace occlod::hlod {

// Passes everything on to a device. Fragments are estimated from bounds, so the times depend on counts and answers
// only.
class ModelledDevice final : public RenderDevice {
 public:
  // Before begin_frame(). Both outlive the frame.
  void set(RenderDevice& device, const FrameScene& scene) {
    device_ = &device;
    scene_ = &scene;
  }
  // Of the last frame.
  [[nodiscard]] double frame_ms() const noexcept { return clock_.times().frame_ms; }

  [[nodiscard]] std::string_view name() const noexcept override { return device_->name(); }
  void begin_frame(const View& view, std::span<const PlacedHlod> objects) override;
  void draw(const NodeDraw& draw) override;
  [[nodiscard]] QueryId ask(std::span<const BoxRef> boxes) override;
  [[nodiscard]] QueryId ask_each(std::span<const BoxRef> boxes) override;
  [[nodiscard]] bool available(QueryId query) override { return device_->available(query); }
  [[nodiscard]] std::span<const std::uint32_t> wait(QueryId query) override;
  void visit(std::size_t nodes) override;
  FrameTimes end_frame() override { return device_->end_frame(); }

 private:
  QueryId note(QueryId query, double query_ns);
  [[nodiscard]] double pixels_of(std::span<const BoxRef> boxes) const;

  RenderDevice* device_ = nullptr;
  const FrameScene* scene_ = nullptr;
  VirtualClock clock_;
  std::vector<double> ready_ns_;  // by query
};

}  // namespace occlod::hlod
