#include "hlod/draw/virtual_device.h"

#include <algorithm>
#include <cassert>
#include <string>
#include <utility>
#include <vector>

#include "occlod/trial_devices.h"

namespace occlod::hlod {

double VirtualClock::command(double submit_ns, double command_ns) {
  cpu_ns_ += submit_ns;
  const double start = std::max(cpu_ns_, gpu_ns_);
  if (commands_ > 0) starve_ns_ += start - gpu_ns_;
  gpu_ns_ = start + command_ns;
  busy_ns_ += command_ns;
  ++commands_;
  return gpu_ns_;
}

void VirtualClock::wait_until(double ns) {
  if (ns <= cpu_ns_) return;
  stall_ns_ += ns - cpu_ns_;
  cpu_ns_ = ns;
}

FrameTimes VirtualClock::times() const noexcept {
  constexpr double ms = 1e-6;
  return {std::max(cpu_ns_, gpu_ns_) * ms, cpu_ns_ * ms, busy_ns_ * ms, stall_ns_ * ms, starve_ns_ * ms};
}

namespace {

// Of a box.
constexpr double box_triangles = 12.0;

}  // namespace

class VirtualDevice::Impl {
 public:
  Impl(DeviceCosts costs, const SoftwareDeviceOptions& options)
      : costs_(std::move(costs)), name_("virtual:" + costs_.name), software_(options) {
    check_device_costs("virtual device", costs_);
  }

  void begin(const View& view, std::span<const PlacedHlod> objects) {
    software_.begin_frame(view, objects);
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
    return software_.wait(query);
  }

  void visit(std::size_t nodes) { clock_.work(static_cast<double>(nodes) * costs_.visit_ns); }

  FrameTimes end() {
    software_.end_frame();
    return clock_.times();
  }

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const SoftwareDevice& software() const noexcept { return software_; }
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
  SoftwareDevice software_;
  VirtualClock clock_;
  std::vector<Query> queries_;  // of this frame
};

VirtualDevice::VirtualDevice(DeviceCosts costs, const SoftwareDeviceOptions& options)
    : impl_(std::make_unique<Impl>(std::move(costs), options)) {}
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
const SoftwareDevice& VirtualDevice::software() const noexcept { return impl_->software(); }
const DeviceCosts& VirtualDevice::costs() const noexcept { return impl_->costs(); }

}  // namespace occlod::hlod
