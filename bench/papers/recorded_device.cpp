#include "papers/recorded_device.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "mesh/section_file.h"
#include "occlod/base.h"
#include "occlod/device.h"
#include "papers/trial_devices.h"

namespace occlod::hlod {
namespace {

// XXH3-64 of the arguments of calls of a device, by which a replay knows that it is told what was recorded. Equal bits,
// equal digests.

class CallDigest {
 public:
  // HLODs by their numbers of nodes and triangles, their box and their bytes of meshes; not by what is in these.
  [[nodiscard]] std::uint64_t of_frame(const View& view, std::span<const PlacedHlod> objects);
  [[nodiscard]] std::uint64_t of_draw(const NodeDraw& draw);
  [[nodiscard]] std::uint64_t of_boxes(std::span<const BoxRef> boxes);
  // Of available, wait and visit.
  [[nodiscard]] std::uint64_t of_number(std::uint64_t number);

 private:
  template <typename T>
  void add_all(std::span<const T> values);
  template <typename T>
  void add(const T& value);
  [[nodiscard]] std::uint64_t finish();

  std::vector<std::byte> bytes_;  // scratch
};

// Of types without padding, whose bytes are their value.
template <typename T>
void CallDigest::add_all(std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  const auto bytes = std::as_bytes(values);
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

template <typename T>
void CallDigest::add(const T& value) {
  add_all(std::span(&value, 1));
}

std::uint64_t CallDigest::finish() {
  const std::uint64_t digest = sections::checksum_of(bytes_);
  bytes_.clear();
  return digest;
}

std::uint64_t CallDigest::of_frame(const View& view, std::span<const PlacedHlod> objects) {
  const Camera& camera = view.camera();
  for (const glm::dvec3& v : {camera.eye, camera.target, camera.up}) add(v);
  for (const double value : {camera.fov_y_deg, camera.near, camera.far, camera.orthographic_height.value_or(0.0)})
    add(value);
  add(std::array{camera.width, camera.height});
  for (const PlacedHlod& placed : objects) {
    const HlodView& hlod = placed.hlod->data();
    add(placed.object_to_world);
    add(std::array{std::uint64_t{placed.two_sided ? 1U : 0U}, std::uint64_t{hlod.nodes.size()},
                   hlod.input_triangle_count, std::uint64_t{hlod.meshes.size()}});
    add(hlod.box);
  }
  return finish();
}

std::uint64_t CallDigest::of_draw(const NodeDraw& draw) {
  add(std::array{draw.object, draw.node, draw.splits, static_cast<std::uint32_t>(draw.ranges.size())});
  add_all(draw.ranges);
  add_all(draw.cut);
  return finish();
}

std::uint64_t CallDigest::of_boxes(std::span<const BoxRef> boxes) {
  add_all(boxes);
  return finish();
}

std::uint64_t CallDigest::of_number(std::uint64_t number) {
  add(number);
  return finish();
}

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

class RecordingDevice::Impl {
 public:
  explicit Impl(RenderDevice& device) : device_(device) { data_.device = device.name(); }

  void begin(const View& view, std::span<const PlacedHlod> objects) {
    drop_unfinished();
    device_.begin_frame(view, objects);
    add(Call::begin_frame, digest_.of_frame(view, objects));
  }
  void draw(const NodeDraw& draw) {
    device_.draw(draw);
    add(Call::draw, digest_.of_draw(draw));
  }
  [[nodiscard]] QueryId ask(std::span<const BoxRef> boxes) {
    const QueryId query = device_.ask(boxes);
    add(Call::ask, digest_.of_boxes(boxes), query, 1);
    return query;
  }
  [[nodiscard]] QueryId ask_each(std::span<const BoxRef> boxes) {
    const QueryId query = device_.ask_each(boxes);
    add(Call::ask_each, digest_.of_boxes(boxes), query, static_cast<std::uint32_t>(boxes.size()));
    return query;
  }
  [[nodiscard]] bool available(QueryId query) {
    const bool is_available = device_.available(query);
    add(Call::available, digest_.of_number(query), query, is_available ? 1 : 0);
    return is_available;
  }
  [[nodiscard]] std::span<const std::uint32_t> wait(QueryId query) {
    const auto counts = device_.wait(query);
    data_.counts.insert(data_.counts.end(), counts.begin(), counts.end());
    add(Call::wait, digest_.of_number(query), query, static_cast<std::uint32_t>(counts.size()));
    return counts;
  }
  void visit(std::size_t nodes) {
    device_.visit(nodes);
    add(Call::visit, digest_.of_number(nodes));
  }
  FrameTimes end() {
    const FrameTimes times = device_.end_frame();
    add(Call::end_frame, 0);
    data_.times.push_back(times);
    whole_calls_ = data_.calls.size();
    whole_counts_ = data_.counts.size();
    return times;
  }

  [[nodiscard]] Recording recording() const {
    RecordingData whole = data_;
    whole.calls.resize(whole_calls_);
    whole.counts.resize(whole_counts_);
    return Recording(std::make_shared<const RecordingData>(std::move(whole)));
  }
  [[nodiscard]] const RenderDevice& device() const noexcept { return device_; }

 private:
  void add(Call call, std::uint64_t digest, QueryId query = 0, std::uint32_t count = 0) {
    data_.calls.push_back({digest, call, query, count, 0});
  }
  void drop_unfinished() {
    data_.calls.resize(whole_calls_);
    data_.counts.resize(whole_counts_);
  }

  RenderDevice& device_;
  RecordingData data_;
  std::size_t whole_calls_ = 0, whole_counts_ = 0;  // of frames that have been ended
  CallDigest digest_;
};

RecordingDevice::RecordingDevice(RenderDevice& device) : impl_(std::make_unique<Impl>(device)) {}
RecordingDevice::~RecordingDevice() = default;

std::string_view RecordingDevice::name() const noexcept { return impl_->device().name(); }
void RecordingDevice::begin_frame(const View& view, std::span<const PlacedHlod> objects) {
  impl_->begin(view, objects);
}
void RecordingDevice::draw(const NodeDraw& draw) { impl_->draw(draw); }
QueryId RecordingDevice::ask(std::span<const BoxRef> boxes) { return impl_->ask(boxes); }
QueryId RecordingDevice::ask_each(std::span<const BoxRef> boxes) { return impl_->ask_each(boxes); }
bool RecordingDevice::available(QueryId query) { return impl_->available(query); }
std::span<const std::uint32_t> RecordingDevice::wait(QueryId query) { return impl_->wait(query); }
void RecordingDevice::visit(std::size_t nodes) { impl_->visit(nodes); }
FrameTimes RecordingDevice::end_frame() { return impl_->end(); }
Recording RecordingDevice::recording() const { return impl_->recording(); }

namespace {

constexpr std::array<const char*, call_count> call_names{"begin_frame", "draw", "ask",   "ask_each",
                                                         "available",   "wait", "visit", "end_frame"};

const char* name_of(Call call) { return call_names[static_cast<std::size_t>(call)]; }

}  // namespace

class ReplayingDevice::Impl {
 public:
  explicit Impl(Recording recording)
      : recording_(std::move(recording)), data_(*recording_.data()), name_("recorded:" + data_.device) {}

  void begin(const View& view, std::span<const PlacedHlod> objects) {
    (void)next(Call::begin_frame, digest_.of_frame(view, objects), "in another view or with other HLODs");
  }
  void draw(const NodeDraw& draw) {
    (void)next(Call::draw, digest_.of_draw(draw), fmt::format("of node {} of object {}", draw.node, draw.object));
  }
  [[nodiscard]] QueryId ask(Call call, std::span<const BoxRef> boxes) {
    const RecordedCall& recorded =
        next(call, digest_.of_boxes(boxes), fmt::format("about {} box{}", boxes.size(), boxes.size() == 1 ? "" : "es"));
    if (call == Call::ask_each && recorded.count != boxes.size()) refuse("asks about another number of boxes");
    return recorded.query;
  }
  [[nodiscard]] bool available(QueryId query) {
    return next(Call::available, digest_.of_number(query), fmt::format("of query {}", query)).count != 0;
  }
  [[nodiscard]] std::span<const std::uint32_t> wait(QueryId query) {
    const RecordedCall& recorded = next(Call::wait, digest_.of_number(query), fmt::format("for query {}", query));
    const auto counts = std::span(data_.counts).subspan(next_count_, recorded.count);
    next_count_ += recorded.count;
    return counts;
  }
  void visit(std::size_t nodes) {
    (void)next(Call::visit, digest_.of_number(nodes), fmt::format("of {} nodes", nodes));
  }
  FrameTimes end() {
    (void)next(Call::end_frame, 0, "");
    call_in_frame_ = 0;
    return data_.times[frame_++];
  }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }

 private:
  // The recorded call, which must be this one. `what`: its arguments, for messages.
  const RecordedCall& next(Call call, std::uint64_t digest, const std::string& what) {
    const std::string told = fmt::format("{}{}{}", name_of(call), what.empty() ? "" : " ", what);
    if (frame_ >= data_.times.size())
      refuse(fmt::format("is told {}, but only {} frames were recorded", told, data_.times.size()));
    const RecordedCall& recorded = data_.calls[next_call_];
    if (recorded.call != call) refuse(fmt::format("is told {}, but {} was recorded", told, name_of(recorded.call)));
    if (recorded.digest != digest)
      refuse(fmt::format("is told {}, but {} was recorded with other arguments", told, name_of(call)));
    ++next_call_;
    ++call_in_frame_;
    return recorded;
  }
  [[noreturn]] void refuse(const std::string& problem) const {
    throw Error({"replay", fmt::format("frame {}, command {}", frame_, call_in_frame_), problem,
                 "replay with the HLODs, the path and the options of the recording"});
  }

  Recording recording_;
  const RecordingData& data_;
  std::string name_;
  std::size_t frame_ = 0;                       // that is replayed, or comes next
  std::size_t call_in_frame_ = 0;               // of it
  std::size_t next_call_ = 0, next_count_ = 0;  // of the recording
  CallDigest digest_;
};

ReplayingDevice::ReplayingDevice(Recording recording) : impl_(std::make_unique<Impl>(std::move(recording))) {}
ReplayingDevice::~ReplayingDevice() = default;

std::string_view ReplayingDevice::name() const noexcept { return impl_->name(); }
void ReplayingDevice::begin_frame(const View& view, std::span<const PlacedHlod> objects) {
  impl_->begin(view, objects);
}
void ReplayingDevice::draw(const NodeDraw& draw) { impl_->draw(draw); }
QueryId ReplayingDevice::ask(std::span<const BoxRef> boxes) { return impl_->ask(Call::ask, boxes); }
QueryId ReplayingDevice::ask_each(std::span<const BoxRef> boxes) { return impl_->ask(Call::ask_each, boxes); }
bool ReplayingDevice::available(QueryId query) { return impl_->available(query); }
std::span<const std::uint32_t> ReplayingDevice::wait(QueryId query) { return impl_->wait(query); }
void ReplayingDevice::visit(std::size_t nodes) { impl_->visit(nodes); }
FrameTimes ReplayingDevice::end_frame() { return impl_->end(); }

}  // namespace occlod::hlod
