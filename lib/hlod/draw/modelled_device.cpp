#include "hlod/draw/modelled_device.h"

#include <algorithm>

#include "hlod/draw/work_below.h"

namespace occlod::hlod {

void ModelledDevice::begin_frame(const View& view, std::span<const PlacedHlod> objects) {
  clock_.begin();
  ready_ns_.clear();
  device_->begin_frame(view, objects);
}

void ModelledDevice::draw(const NodeDraw& draw) {
  const NodeRef n{draw.object, draw.node};
  const Node& node = scene_->node(n);
  double triangles = static_cast<double>(draw.cut.size()) / 3.0;
  for (const DrawRange& range : draw.ranges) triangles += static_cast<double>(range.index_count) / 3.0;
  DrawWork work = own_work(*scene_, n, scene_->view_of(n).coverage(node.box));
  if (!draw.ranges.empty()) work.fragments *= triangles / static_cast<double>(node.triangles);
  work.triangles = triangles;
  const DeviceCosts& costs = scene_->options().costs;
  clock_.command(costs.submit_ns, draw_time_ns(costs, work));
  device_->draw(draw);
}

double ModelledDevice::pixels_of(std::span<const BoxRef> boxes) const {
  double pixels = 0.0;
  for (const BoxRef& box : boxes) {
    const ObjectFrame& view = scene_->view_of({box.object, 0});
    pixels += view.coverage(box.box) * view.pixels();
  }
  return pixels;
}

QueryId ModelledDevice::note(QueryId query, double query_ns) {
  const DeviceCosts& costs = scene_->options().costs;
  if (ready_ns_.size() <= query) ready_ns_.resize(query + std::size_t{1});
  ready_ns_[query] = clock_.command(costs.submit_ns, query_ns) + costs.readback_ns;
  return query;
}

QueryId ModelledDevice::ask(std::span<const BoxRef> boxes) {
  return note(device_->ask(boxes), query_time_ns(scene_->options().costs, pixels_of(boxes)));
}

QueryId ModelledDevice::ask_each(std::span<const BoxRef> boxes) {
  const DeviceCosts& costs = scene_->options().costs;
  return note(device_->ask_each(boxes),
              std::max(costs.batch_ns + static_cast<double>(boxes.size()) * costs.batch_item_ns,
                       pixels_of(boxes) * costs.query_fragment_ns));
}

std::span<const std::uint32_t> ModelledDevice::wait(QueryId query) {
  clock_.wait_until(ready_ns_[query]);
  return device_->wait(query);
}

void ModelledDevice::visit(std::size_t nodes) {
  clock_.work(static_cast<double>(nodes) * scene_->options().costs.visit_ns);
  device_->visit(nodes);
}

}  // namespace occlod::hlod
