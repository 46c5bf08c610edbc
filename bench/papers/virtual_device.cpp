#include <algorithm>
#include <array>
#include <cassert>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/file_input.h"
#include "hlod/draw/software_drawing.h"
#include "hlod/draw/virtual_clock.h"
#include "occlod/base.h"
#include "papers/trial_devices.h"

namespace occlod::hlod {
namespace {

// Grounds: docs/internals/hlod.md.
const std::array<DeviceCosts, 4>& presets() {
  static const std::array<DeviceCosts, 4> all{{
      {.name = "query-cheap",
       .draw_ns = 10'000.0,
       .triangle_ns = 8.0,
       .fragment_ns = 0.3,
       .query_ns = 3'000.0,
       .query_fragment_ns = 0.1,
       .wrapped_query_ns = 3'000.0,
       .readback_ns = 15'000.0,
       .batch_ns = 200'000.0,
       .batch_item_ns = 200.0,
       .submit_ns = 3'000.0,
       .visit_ns = 500.0},
      {.name = "query-dear",
       .draw_ns = 15'000.0,
       .triangle_ns = 14.0,
       .fragment_ns = 1.5,
       .query_ns = 12'000.0,
       .query_fragment_ns = 0.5,
       .wrapped_query_ns = 12'000.0,
       .readback_ns = 50'000.0,
       .batch_ns = 400'000.0,
       .batch_item_ns = 500.0,
       .submit_ns = 5'000.0,
       .visit_ns = 1'000.0},
      {.name = "fill-bound",
       .draw_ns = 10'000.0,
       .triangle_ns = 8.0,
       .fragment_ns = 4.0,
       .query_ns = 4'000.0,
       .query_fragment_ns = 0.4,
       .wrapped_query_ns = 4'000.0,
       .readback_ns = 15'000.0,
       .batch_ns = 300'000.0,
       .batch_item_ns = 200.0,
       .submit_ns = 3'000.0,
       .visit_ns = 500.0},
      {.name = "modern",
       .draw_ns = 1'000.0,
       .triangle_ns = 0.3,
       .fragment_ns = 0.05,
       .query_ns = 2'000.0,
       .query_fragment_ns = 0.01,
       .wrapped_query_ns = 2'000.0,
       .readback_ns = 20'000.0,
       .batch_ns = 40'000.0,
       .batch_item_ns = 10.0,
       .submit_ns = 500.0,
       .visit_ns = 50.0},
  }};
  return all;
}

// Of a box.
constexpr double box_triangles = 12.0;

}  // namespace

class VirtualDevice::Impl {
 public:
  Impl(DeviceCosts costs, std::shared_ptr<NodeImages> images)
      : costs_(std::move(costs)), name_("virtual:" + costs_.name) {
    check_device_costs("virtual device", costs_);
    software_.share_images(std::move(images));
  }

  void begin(const View& view, std::span<const PlacedHlod> objects) {
    software_.begin(view, objects);
    clock_.begin();
    queries_.clear();
  }

  void draw(const NodeDraw& draw) {
    const DeviceWork before = software_.work();
    software_.draw(draw);
    const auto triangles = static_cast<double>(software_.work().triangles - before.triangles);
    const auto fragments = static_cast<double>(software_.work().fragments - before.fragments);
    clock_.command(costs_.submit_ns, std::max({costs_.draw_ns, triangles * costs_.triangle_ns,  //
                                               fragments * costs_.fragment_ns}));
  }

  QueryId ask(std::span<const BoxRef> boxes) {
    const DeviceWork before = software_.work();
    const QueryId query = software_.ask(boxes);
    return add(query, before, [&](double drawn, double fragments) {
      return std::max({costs_.query_ns, box_triangles * drawn * costs_.triangle_ns,  //
                       fragments * costs_.query_fragment_ns});
    });
  }

  QueryId ask_each(std::span<const BoxRef> boxes) {
    const DeviceWork before = software_.work();
    const QueryId query = software_.ask_each(boxes);
    return add(query, before, [&](double drawn, double fragments) {
      return std::max(costs_.batch_ns + drawn * costs_.batch_item_ns, fragments * costs_.query_fragment_ns);
    });
  }

  [[nodiscard]] bool available(QueryId query) const {
    assert(query < queries_.size());
    return queries_[query].ready_ns <= clock_.cpu_ns() && queries_[query].ready_commands <= clock_.commands();
  }

  std::span<const std::uint32_t> wait(QueryId query) {
    assert(query < queries_.size());
    clock_.wait_until(queries_[query].ready_ns);
    queries_[query].ready_commands = 0;  // read is read
    return software_.answer(query);
  }

  void visit(std::size_t nodes) { clock_.work(static_cast<double>(nodes) * costs_.visit_ns); }

  FrameTimes end() { return clock_.times(); }

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const SoftwareDrawing& software() const noexcept { return software_; }
  [[nodiscard]] const DeviceCosts& costs() const noexcept { return costs_; }

 private:
  struct Query {
    double ready_ns = 0.0;             // of the clock of the calling thread
    std::uint64_t ready_commands = 0;  // given in this frame
  };

  // `work`: what was done before `query`. time_of(boxes drawn, their fragments): ns on the device.
  template <typename TimeOf>
  QueryId add(QueryId query, const DeviceWork& work, const TimeOf& time_of) {
    assert(query == queries_.size());
    const std::uint64_t drawn = software_.work().drawn_boxes - work.drawn_boxes;
    const std::uint64_t fragments = software_.work().query_fragments - work.query_fragments;
    Query added;
    if (drawn > 0) {
      const double end =
          clock_.command(costs_.submit_ns, time_of(static_cast<double>(drawn), static_cast<double>(fragments)));
      added = {end + costs_.readback_ns, clock_.commands() + costs_.latency_commands};
    }
    queries_.push_back(added);
    return query;
  }

  DeviceCosts costs_;
  std::string name_;
  SoftwareDrawing software_{false};
  VirtualClock clock_;
  std::vector<Query> queries_;  // of this frame
};

VirtualDevice::VirtualDevice(DeviceCosts costs, std::shared_ptr<NodeImages> images)
    : impl_(std::make_unique<Impl>(std::move(costs), std::move(images))) {}
VirtualDevice::~VirtualDevice() = default;

std::string_view VirtualDevice::name() const noexcept { return impl_->name(); }
void VirtualDevice::begin_frame(const View& view, std::span<const PlacedHlod> objects) { impl_->begin(view, objects); }
void VirtualDevice::draw(const NodeDraw& draw) { impl_->draw(draw); }
QueryId VirtualDevice::ask(std::span<const BoxRef> boxes) { return impl_->ask(boxes); }
QueryId VirtualDevice::ask_each(std::span<const BoxRef> boxes) { return impl_->ask_each(boxes); }
bool VirtualDevice::available(QueryId query) { return impl_->available(query); }
std::span<const std::uint32_t> VirtualDevice::wait(QueryId query) { return impl_->wait(query); }
void VirtualDevice::visit(std::size_t nodes) { impl_->visit(nodes); }
FrameTimes VirtualDevice::end_frame() { return impl_->end(); }
const SoftwareDrawing& VirtualDevice::software() const noexcept { return impl_->software(); }
const DeviceCosts& VirtualDevice::costs() const noexcept { return impl_->costs(); }

std::span<const DeviceCosts> device_presets() { return presets(); }

const DeviceCosts& device_preset(std::string_view name) {
  const auto found =
      std::find_if(presets().begin(), presets().end(), [&](const DeviceCosts& costs) { return costs.name == name; });
  if (found != presets().end()) return *found;
  std::string names;
  for (const DeviceCosts& costs : presets()) names += (names.empty() ? "" : ", ") + costs.name;
  throw Error({"virtual device", "preset " + in_quotes(name), "is none of " + names, "choose one of them"});
}

}  // namespace occlod::hlod
