#include <fmt/format.h>

#include <array>
#include <utility>

#include "hlod/draw/call_digest.h"
#include "hlod/draw/recording_data.h"
#include "occlod/core/error.h"
#include "occlod/device/recorded_device.h"

namespace occlod::hlod {
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
