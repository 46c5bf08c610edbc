#include "hlod/draw/recording_data.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <unordered_map>
#include <utility>

#include "occlod/device/recorded_device.h"

namespace occlod::hlod {
namespace {

// Walks along the calls once.
class Checker {
 public:
  explicit Checker(const RecordingData& data) : data_(data) {}

  [[nodiscard]] std::optional<std::string> problem() {
    for (std::size_t i = 0; i < data_.calls.size(); ++i)
      if (const char* what = problem_of(data_.calls[i])) return fmt::format("call {} {}", i, what);
    if (in_frame_) return "its last frame has no end";
    if (counts_ != data_.counts.size())
      return fmt::format("{} counts, {} were waited for", data_.counts.size(), counts_);
    if (frames_ != data_.times.size())
      return fmt::format("times of {} frames, {} were ended", data_.times.size(), frames_);
    const auto finite = [](const FrameTimes& t) {
      return std::isfinite(t.frame_ms + t.cpu_ms + t.gpu_ms + t.stall_ms + t.starve_ms);
    };
    if (!std::all_of(data_.times.begin(), data_.times.end(), finite)) return "times that are not finite";
    return std::nullopt;
  }

 private:
  [[nodiscard]] const char* problem_of(const RecordedCall& call) {
    if (static_cast<std::uint32_t>(call.call) >= call_count || call.reserved != 0) return "is none";
    if ((call.call == Call::begin_frame) == in_frame_) return "is on the wrong side of a frame's beginning or end";
    switch (call.call) {
      case Call::begin_frame:
        in_frame_ = true;
        asked_.clear();
        break;
      case Call::end_frame:
        in_frame_ = false;
        ++frames_;
        break;
      case Call::ask:
      case Call::ask_each:
        if (call.call == Call::ask && call.count != 1) return "asks for more or less than one count";
        if (!asked_.emplace(call.query, call.count).second) return "asks under a number that is taken";
        return nullptr;
      case Call::available:
        return asked_.contains(call.query) && call.count <= 1 ? nullptr : "has no query or says neither yes nor no";
      case Call::wait: {
        const auto query = asked_.find(call.query);
        if (query == asked_.end() || query->second != call.count) return "waits for what was not asked";
        counts_ += call.count;
        return nullptr;
      }
      case Call::draw:
      case Call::visit:
        break;
    }
    return call.query == 0 && call.count == 0 ? nullptr : "has an answer";
  }

  const RecordingData& data_;
  bool in_frame_ = false;
  std::uint64_t counts_ = 0, frames_ = 0;
  std::unordered_map<std::uint32_t, std::uint32_t> asked_;  // counts by query, of the frame
};

}  // namespace

std::optional<std::string> check_recording(const RecordingData& data) { return Checker(data).problem(); }

Recording::Recording() : data_(std::make_shared<const RecordingData>()) {}
Recording::Recording(std::shared_ptr<const RecordingData> data) : data_(std::move(data)) {}
const std::string& Recording::device_name() const noexcept { return data_->device; }
std::size_t Recording::frame_count() const noexcept { return data_->times.size(); }
std::size_t Recording::command_count() const noexcept { return data_->calls.size(); }

void write_recording(const std::filesystem::path& path, const Recording& recording) {
  const RecordingData& data = *recording.data();
  sections::SectionWriter writer;
  writer.add(calls_name, std::span<const RecordedCall>(data.calls));
  writer.add(counts_name, std::span<const std::uint32_t>(data.counts));
  writer.add(times_name, std::span<const FrameTimes>(data.times));
  writer.add(hlod::device_name, std::span<const char>(data.device));
  writer.write(path, recording_kind);
}

Recording read_recording(const std::filesystem::path& path) {
  sections::SectionReader reader(path, recording_kind, false);
  const auto copy = [](const auto& values, auto& target) { target.assign(values.begin(), values.end()); };
  RecordingData data;
  copy(reader.read<RecordedCall>(calls_name), data.calls);
  copy(reader.read<std::uint32_t>(counts_name), data.counts);
  copy(reader.read<FrameTimes>(times_name), data.times);
  copy(reader.read<char>(hlod::device_name), data.device);
  if (const auto problem = check_recording(data)) reader.refuse("", "does not hold a valid recording: " + *problem);
  return Recording(std::make_shared<const RecordingData>(std::move(data)));
}

}  // namespace occlod::hlod
