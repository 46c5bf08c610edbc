#include <cassert>
#include <utility>

#include "hlod/draw/call_digest.h"
#include "hlod/draw/recording_data.h"
#include "occlod/device/recorded_device.h"

namespace occlod::hlod {

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

}  // namespace occlod::hlod
