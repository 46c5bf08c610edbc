#include "hlod/draw/software_drawing.h"

namespace occlod::hlod {

class SoftwareDevice::Impl : public SoftwareDrawing {
 public:
  using SoftwareDrawing::SoftwareDrawing;
};

SoftwareDevice::SoftwareDevice(bool keep_items) : impl_(std::make_unique<Impl>(keep_items)) {}
SoftwareDevice::~SoftwareDevice() = default;

void SoftwareDevice::set_slack(double pixels) noexcept { impl_->set_slack(pixels); }
std::string_view SoftwareDevice::name() const noexcept { return "software"; }
void SoftwareDevice::begin_frame(const View& view, std::span<const PlacedHlod> objects) { impl_->begin(view, objects); }
void SoftwareDevice::draw(const NodeDraw& draw) { impl_->draw(draw); }
QueryId SoftwareDevice::ask(std::span<const BoxRef> boxes) { return impl_->ask(boxes); }
QueryId SoftwareDevice::ask_each(std::span<const BoxRef> boxes) { return impl_->ask_each(boxes); }
bool SoftwareDevice::available(QueryId /*query*/) { return true; }
std::span<const std::uint32_t> SoftwareDevice::wait(QueryId query) { return impl_->answer(query); }
void SoftwareDevice::visit(std::size_t /*nodes*/) {}
FrameTimes SoftwareDevice::end_frame() { return impl_->end(); }
const DeviceWork& SoftwareDevice::work() const noexcept { return impl_->work(); }
DepthBuffer SoftwareDevice::depth() const { return impl_->depth(); }
const ItemBuffer& SoftwareDevice::items() const noexcept { return impl_->items(); }

}  // namespace occlod::hlod
