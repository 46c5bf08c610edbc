// Devices of trials, for comparisons that can be repeated to the bit. `virtual`: the answers of `software` under a
// simulated clock, so that frame times can be repeated.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "occlod/device.h"
#include "occlod/device_costs.h"

namespace occlod::hlod {

class NodeImages;
class SoftwareDrawing;

// Two clocks start each frame at 0: c of the calling thread, g of the device. A command adds submit_ns to c; it starts
// on the device at max(c, g), takes what DeviceCosts says with the fragments that it really has, and g is then its end.
// A visit adds visit_ns to c. An answer can be read readback_ns after its query has ended: available() compares that
// with c, wait() sets c to it if it is later, and the difference is stall. Boxes that count all or no pixels without
// being drawn (RenderDevice::ask) cost nothing; a query of nothing else can be read at once. Gaps of g between commands
// are starvation; the frame ends at max(c, g). So times are the same on every machine.
class VirtualDevice final : public RenderDevice {
 public:
  // Throws Error for a cost that is negative or not finite.
  // `images`: see SoftwareDrawing::share_images().
  explicit VirtualDevice(DeviceCosts costs, std::shared_ptr<NodeImages> images = nullptr);
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
  [[nodiscard]] const SoftwareDrawing& software() const noexcept;
  // As given.
  [[nodiscard]] const DeviceCosts& costs() const noexcept;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

// `query-cheap`, `query-dear`, `fill-bound` and `modern`. What they stand for: docs/internals/hlod.md.
[[nodiscard]] std::span<const DeviceCosts> device_presets();

// The preset of this name. Throws Error that lists the names.
[[nodiscard]] const DeviceCosts& device_preset(std::string_view name);

// The device `recorded`: what a device was told and answered, kept in a file and replayed, so that a run on any machine
// can be repeated to the bit.

struct RecordingData;

// Frames as a device saw them: a digest of each command, each answer, what available() said each time, and the times of
// each frame. Immutable; copies share it.
class Recording {
 public:
  // Of no frames.
  Recording();
  // For RecordingDevice and read_recording().
  explicit Recording(std::shared_ptr<const RecordingData> data);

  // RenderDevice::name() of the device that was recorded.
  [[nodiscard]] const std::string& device_name() const noexcept;
  // Frames that were ended.
  [[nodiscard]] std::size_t frame_count() const noexcept;
  // Calls in all frames, begin_frame() and end_frame() too.
  [[nodiscard]] std::size_t command_count() const noexcept;
  // For ReplayingDevice and write_recording().
  [[nodiscard]] const std::shared_ptr<const RecordingData>& data() const noexcept { return data_; }

 private:
  std::shared_ptr<const RecordingData> data_;
};

// Writes an .orec file, 24 bytes a command and 4 an answer; it appears whole or not at all. Throws Error that names it.
void write_recording(const std::filesystem::path& path, const Recording& recording);
// Throws Error for a file that is missing, truncated, damaged, of another kind or not what write_recording() writes.
[[nodiscard]] Recording read_recording(const std::filesystem::path& path);

// Hands everything on to another device, and writes it down.
class RecordingDevice final : public RenderDevice {
 public:
  // `device` outlives it.
  explicit RecordingDevice(RenderDevice& device);
  ~RecordingDevice() override;

  // As the other device's.
  [[nodiscard]] std::string_view name() const noexcept override;
  void begin_frame(const View& view, std::span<const PlacedHlod> objects) override;
  void draw(const NodeDraw& draw) override;
  [[nodiscard]] QueryId ask(std::span<const BoxRef> boxes) override;
  [[nodiscard]] QueryId ask_each(std::span<const BoxRef> boxes) override;
  [[nodiscard]] bool available(QueryId query) override;
  [[nodiscard]] std::span<const std::uint32_t> wait(QueryId query) override;
  void visit(std::size_t nodes) override;
  FrameTimes end_frame() override;

  // The frames that have been ended so far. One that was left by an exception is not there. O(its size).
  [[nodiscard]] Recording recording() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

// Answers as the recorded device did, without drawing. Each call throws Error, naming frame and command, when it is not
// what was recorded there: another call, other arguments, another view or other HLODs; and when the recording has no
// more frames. Times are the recorded ones.
class ReplayingDevice final : public RenderDevice {
 public:
  // From the first frame on.
  explicit ReplayingDevice(Recording recording);
  ~ReplayingDevice() override;

  // "recorded:" and the name of the device that was recorded.
  [[nodiscard]] std::string_view name() const noexcept override;
  void begin_frame(const View& view, std::span<const PlacedHlod> objects) override;
  void draw(const NodeDraw& draw) override;
  [[nodiscard]] QueryId ask(std::span<const BoxRef> boxes) override;
  [[nodiscard]] QueryId ask_each(std::span<const BoxRef> boxes) override;
  [[nodiscard]] bool available(QueryId query) override;
  [[nodiscard]] std::span<const std::uint32_t> wait(QueryId query) override;
  void visit(std::size_t nodes) override;
  FrameTimes end_frame() override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace occlod::hlod
