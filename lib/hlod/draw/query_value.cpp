#include "hlod/draw/query_value.h"

#include <algorithm>
#include <cmath>

namespace occlod::hlod {

double draw_time_ns(const DeviceCosts& costs, const DrawWork& work) noexcept {
  return std::max({work.draws * costs.draw_ns, work.triangles * costs.triangle_ns, work.fragments * costs.fragment_ns});
}

double query_time_ns(const DeviceCosts& costs, double box_pixels) noexcept {
  return std::max(costs.query_ns, box_pixels * costs.query_fragment_ns);
}

QueryValue query_value(double draw_ns, double query_ns, double occlusion_probability, double depth) noexcept {
  return {draw_ns, query_ns, occlusion_probability * (draw_ns - query_ns) / depth};
}

bool is_query_reasonable(const DeviceCosts& costs, const QueryValue& node, const AskedBefore& before,
                         const ChildrenValue* children) noexcept {
  if (node.draw_ns < node.query_ns) return false;
  if (children != nullptr && children->query_ns < node.query_ns) return false;
  if (before.last == LastSight::hidden) return true;
  if (before.last == LastSight::outside)
    return node.query_ns + (1.0 - before.occlusion_probability) * node.draw_ns < node.draw_ns;
  if (node.query_ns > before.frames_since_asked * node.benefit_ns) return false;
  if (children == nullptr || children->any_unaskable) return true;
  return node.benefit_ns > children->benefit_ns && costs.wrapped_query_ns * children->leaves > node.query_ns;
}

double max_parallel_queries(const DeviceCosts& costs) noexcept {
  const double least = std::min(costs.query_ns, costs.wrapped_query_ns + costs.draw_ns);
  return least > 0.0 ? std::ceil((costs.query_ns + costs.readback_ns) / least) + 1.0 : 1.0;
}

namespace {

// A pixel counts as two fragments (Guthe and others 2006, sec. 3.2.1), because a closed surface has two layers.
constexpr double layers = 2.0;

// Calls visit(parent, share) for each patch with a parent.
template <typename Visit>
void for_each_share(const FrameScene& scene, NodeRef n, const Visit& visit) {
  for (const Patch& patch : scene.hlod(n).patches(n.node))
    if (patch.parent != no_id)
      visit(NodeRef{n.object, patch.parent},
            static_cast<float>(patch.index_count) / (3.0F * static_cast<float>(scene.node(n).triangles)));
}

}  // namespace

double box_area(const Box& box) {
  const glm::dvec3 extent = glm::dvec3(box.max) - glm::dvec3(box.min);
  return 2.0 * (extent.x * extent.y + extent.y * extent.z + extent.z * extent.x);
}

DrawWork own_work(const FrameScene& scene, NodeRef n, double coverage) {
  const Node& node = scene.node(n);
  const double ratio = coverage_ratio(static_cast<double>(node.area), box_area(node.box));
  return {1.0, static_cast<double>(node.triangles), layers * scene.view_of(n).pixels() * ratio * coverage};
}

double own_coverage(const FrameScene& scene, NodeRef n) {
  const Node& node = scene.node(n);
  return mesh_coverage(scene.view_of(n).coverage(node.box),
                       coverage_ratio(static_cast<double>(node.area), box_area(node.box)));
}

double root_share(const Hlod& hlod, const ObjectFrame& view) {
  double pixels = 0.0;
  for (const NodeId root : hlod.data().roots) pixels += view.box_pixels(hlod.node(root)).value_or(view.pixels());
  return std::min(1.0, pixels / view.pixels());
}

void Covered::begin_frame(const FrameScene& scene) {
  covered_ = 0.0;
  scene_share_ = 1.0;
  if (scene.trial().cover_model == CoverModel::printed) return;
  double sum = 0.0;
  for (std::uint32_t object = 0; object < scene.object_count() && sum < 1.0; ++object)
    sum += root_share(scene.hlod({object, 0}), scene.view_of({object, 0}));
  scene_share_ = sum > 0.0 ? std::min(1.0, sum) : 1.0;
}

void Covered::note_drawn(const FrameScene& scene, NodeRef n) {
  covered_ = covered_with(covered_, std::min(1.0, own_coverage(scene, n) / scene_share_));
}

double Covered::probability(double coverage) const {
  return cover_probability(covered_, std::min(1.0, coverage / scene_share_));
}

LastSight last_sight(const FrameScene& scene, NodeRef n) {
  const LastFrame last = scene.last(n);
  if (!last.visited) return LastSight::outside;
  return last.visible ? LastSight::visible : LastSight::hidden;
}

void WorkBelow::begin_frame(const FrameScene& scene) {
  visited_.clear();
  if (records_.fit(scene)) add_up_level_0(scene);
}

void WorkBelow::add_up_level_0(const FrameScene& scene) {
  for (std::uint32_t object = 0; object < scene.object_count(); ++object)
    for (auto id = static_cast<NodeId>(scene.hlod({object, 0}).node_count()); id-- > 0;) {
      const NodeRef n{object, id};
      Record& record = records_[n];
      if (scene.node(n).level == 0) {
        record.all_draws = 1.0F;
        record.all_triangles = static_cast<float>(scene.node(n).triangles);
      }
      for_each_share(scene, n, [&](NodeRef parent, float share) {
        records_[parent].all_draws += share * record.all_draws;
        records_[parent].all_triangles += share * record.all_triangles;
      });
    }
}

void WorkBelow::note_drawn(const FrameScene& scene, NodeRef n) {
  records_[n].now_draws = 1.0F;
  records_[n].now_triangles = static_cast<float>(scene.node(n).triangles);
}

void WorkBelow::end_frame(const FrameScene& scene) {
  std::sort(visited_.begin(), visited_.end(), [](NodeRef a, NodeRef b) {  // children before parents
    return a.object != b.object ? a.object < b.object : a.node > b.node;
  });
  for (const NodeRef n : visited_) {
    Record& record = records_[n];
    if (!(record.now_draws > 0.0F)) continue;
    record.draws = record.now_draws;
    record.triangles = record.now_triangles;
    for_each_share(scene, n, [&](NodeRef parent, float share) {
      const NodeState& state = scene.state(parent);
      if (state.frame != scene.frame() || state.status != Status::refined) return;
      records_[parent].now_draws += share * record.now_draws;
      records_[parent].now_triangles += share * record.now_triangles;
    });
    record.now_draws = record.now_triangles = 0.0F;
  }
}

DrawWork WorkBelow::of(const FrameScene& scene, NodeRef n, double coverage) const {
  const Record& record = records_[n];
  const DrawWork own = own_work(scene, n, coverage);
  if (scene.is_fine(n, 1.0)) return own;
  if (record.draws > 0.0F) return {record.draws, record.triangles, own.fragments};
  return refined(scene, n, coverage);
}

DrawWork WorkBelow::refined(const FrameScene& scene, NodeRef n, double coverage) const {
  const Node& node = scene.node(n);
  const Record& record = records_[n];
  const double fragments = own_work(scene, n, coverage).fragments;
  if (record.draws > 0.0F && !(record.draws == 1.0F && record.triangles == static_cast<float>(node.triangles)))
    return {record.draws, record.triangles, fragments};
  const double tolerance = scene.options().tolerance_px;
  const double all = record.all_triangles;
  if (!(tolerance > 0.0)) return {record.all_draws, all, fragments};
  // A quarter of the triangles has four times the error.
  const double triangles = std::min(all, node.triangles * std::max(1.0, scene.error_px(n) / tolerance));
  return {std::max(1.0, record.all_draws * triangles / std::max(all, 1.0)), triangles, fragments};
}

namespace {

constexpr double kept = 0.98;          // share of the counts that is kept from frame to frame
constexpr double prior_frames = 16.0;  // weight of the first guess in frames
constexpr double prior_nodes = 2.0;    // weight of the first guess in nodes
constexpr double min_rate = 0.002;     // a guess: nothing stays visible for ever

}  // namespace

std::size_t HidingRates::class_of(double cover_probability) {
  const double place = cover_probability * static_cast<double>(classes);
  return std::min(static_cast<std::size_t>(std::max(place, 0.0)), classes - 1);
}

void HidingRates::begin_frame() {
  for (auto* counts : {&visible_, &new_})
    for (Count& count : *counts) count = {kept * count.hidden, kept * count.all};
}

void HidingRates::note_visible(double cover_probability, double frames, bool hidden) {
  Count& count = visible_[class_of(cover_probability)];
  count.all += std::max(frames, 1.0);
  count.hidden += hidden ? 1.0 : 0.0;
}

void HidingRates::note_new(double cover_probability, bool hidden) {
  Count& count = new_[class_of(cover_probability)];
  count.all += 1.0;
  count.hidden += hidden ? 1.0 : 0.0;
}

double HidingRates::of_visible(double cover_probability) const {
  const Count& count = visible_[class_of(cover_probability)];
  const double guess = std::max(0.5 * cover_probability * cover_probability, min_rate);
  return (count.hidden + prior_frames * guess) / (count.all + prior_frames);
}

double HidingRates::of_new(double cover_probability) const {
  const Count& count = new_[class_of(cover_probability)];
  return (count.hidden + prior_nodes * cover_probability) / (count.all + prior_nodes);
}

std::size_t HiddenGroups::group(std::span<NodeRef> hidden) const {
  std::sort(hidden.begin(), hidden.end(), [this](NodeRef a, NodeRef b) {
    if (hidden_frames_[a] != hidden_frames_[b]) return hidden_frames_[a] > hidden_frames_[b];
    return a.object != b.object ? a.object < b.object : a.node < b.node;
  });
  double keep = 1.0, best = 0.0;
  for (std::size_t m = 1; m <= hidden.size(); ++m) {
    keep *= 0.99 - 0.7 * std::exp(-static_cast<double>(hidden_frames_[hidden[m - 1]]));
    const auto size = static_cast<double>(m);
    const double value = size / (1.0 + (1.0 - keep) * size);
    if (value < best) return m - 1;
    best = value;
  }
  return hidden.size();
}

}  // namespace occlod::hlod
