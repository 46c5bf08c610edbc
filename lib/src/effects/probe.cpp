#include "probe.h"

#include <algorithm>
#include <cmath>

#include "occlod/occlusion/software_occlusion.h"
#include "priority/queue.h"

namespace occlod {
namespace {

constexpr int image_divisor = 4;
constexpr std::size_t walks_ahead = 64;
constexpr std::size_t walks_back = 128;  // more than ahead: looks back are rarer and decide for longer
constexpr std::size_t most_roots = 256;  // limits the roots that are sampled in scenes of thousands of components
constexpr std::size_t scout_triangles =
    160;  // added to the base meshes; more than OccluderSteps needs for its first occluder
constexpr std::size_t most_below = 16;    // nodes counted below a sample
constexpr float least_level_px = 1e-3F;   // the level of a fully refined mesh
constexpr float largest_error_px = 1e4F;  // for nodes whose bounds contain the eye

Camera smaller(Camera camera) {
  camera.width = std::max(1, camera.width / image_divisor);
  camera.height = std::max(1, camera.height / image_divisor);
  return camera;
}

// None of nothing.
double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

}  // namespace

// Passed to the refiner as its backend: draws occluders into a smaller image and answers every query with visible.
class Probe::SmallVisibility final : public Visibility {
 public:
  explicit SmallVisibility(std::span<const RefineObject> objects) : objects_(objects) {}

  [[nodiscard]] std::string_view name() const noexcept override { return "probe"; }
  void begin_view(const View& view, std::span<const ObjectView> /*objects*/) override {
    const View small(smaller(view.camera()));
    views_.clear();
    for (const RefineObject& object : objects_) views_.emplace_back(small, object.object_to_world);
    software_->begin_view(small, views_);
    drawn_ = false;
  }
  void draw_occluder(std::span<const OccluderPart> parts) override {
    software_->draw_occluder(parts);
    drawn_ = true;
  }
  void submit(const VisibilityQuery& /*query*/) override {}
  [[nodiscard]] std::uint32_t collect() override { return 1; }

  [[nodiscard]] bool drawn() const { return drawn_; }
  [[nodiscard]] bool hides(const VisibilityQuery& query) {
    software_->submit(query);
    return software_->collect() == 0;
  }

 private:
  std::span<const RefineObject> objects_;
  std::unique_ptr<Visibility> software_ = make_software_occlusion();
  std::vector<ObjectView> views_;
  bool drawn_ = false;
};

Probe::Probe(std::span<const RefineObject> objects)
    : objects_(objects.begin(), objects.end()),
      scout_(objects_),
      visibility_(std::make_unique<SmallVisibility>(objects_)) {
  for (const RefineObject& object : objects_) importances_.emplace_back(object);
}
Probe::~Probe() = default;

void Probe::set_transform(std::size_t object, const glm::dmat4& object_to_world) {
  scout_.set_transform(object, object_to_world);
  objects_[object].object_to_world = object_to_world;
}

const Probe::Result& Probe::look_ahead(const View& view, const RefineOptions& options) {
  RefineOptions coarse = options;
  coarse.budget = std::min(options.budget, scout_.base_triangles() + scout_triangles);
  coarse.occluder.splits.clear();
  coarse.occluder.retest_hidden = coarse.queries.final_check = false;
  coarse.effects = {};
  const RefineStats& stats = scout_.refine(view, coarse, *visibility_).stats;
  begin(view, options);
  // Errors fall with one over the number of triangles.
  level_ahead_px_ = stats.level_px * static_cast<double>(stats.triangles) / static_cast<double>(options.budget);
  if (visibility_->drawn()) sample(level_ahead_px_, walks_ahead);
  return result_;
}

const Probe::Result& Probe::look_back(const View& view, const RefineOptions& options, const Refinement& refinement,
                                      double level_px) {
  begin(view, options);
  visibility_->begin_view(view, views_);
  corners_.resize(objects_.size());
  corner_triangles_.resize(objects_.size());
  std::vector<OccluderPart> parts;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const std::span<const glm::vec3> positions = objects_[i].hierarchy->positions();
    corners_[i].clear();
    corner_triangles_[i].clear();
    for (const Triangle& t : refinement.objects[i].triangles) {
      const auto first = static_cast<VertexId>(corners_[i].size());
      corners_[i].insert(corners_[i].end(), {positions[t.x], positions[t.y], positions[t.z]});
      corner_triangles_[i].emplace_back(first, first + 1, first + 2);
    }
    parts.push_back({i, corners_[i], corner_triangles_[i]});
  }
  visibility_->draw_occluder(parts);
  sample(level_px, walks_back);
  return result_;
}

void Probe::begin(const View& view, const RefineOptions& options) {
  options_ = options;
  views_.clear();
  for (const RefineObject& object : objects_) views_.emplace_back(view, object.object_to_world);
  for (std::size_t i = 0; i < objects_.size(); ++i) importances_[i].begin(views_[i], options_);
  result_.all = {};
  result_.objects.assign(objects_.size(), {});
  sums_.assign(objects_.size(), {});
  state_ = 0;
}

void Probe::sample(double level_px, std::size_t walks) {
  find_roots();
  if (roots_.empty()) return;
  const float level = std::isfinite(level_px) ? std::max(static_cast<float>(level_px), least_level_px) : 1.0F;
  for (std::size_t i = 0; i < walks; ++i) count(walk(level), level);
  Sums all;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    all.add(sums_[i]);
    result_.objects[i] = sums_[i].shares();
  }
  result_.all = all.shares();
}

void Probe::Sums::add(const Sums& o) {
  samples += o.samples;
  split_samples += o.split_samples;
  visits += o.visits;
  visits_hidden += o.visits_hidden;
  splits += o.splits;
  splits_hidden += o.splits_hidden;
  stars_hidden += o.stars_hidden;
  seen += o.seen;
  below += o.below;
}

HiddenShares Probe::Sums::shares() const {
  const double growth = seen > 0.0 ? std::min(1.0, below / seen) : 1.0;
  return {
      samples, split_samples, share(visits_hidden, visits), share(splits_hidden, splits), share(stars_hidden, splits),
      growth};
}

// Every n-th root of all forests, at most most_roots.
void Probe::find_roots() {
  std::size_t count = 0;
  for (const RefineObject& object : objects_) count += object.hierarchy->data().roots.size();
  const std::size_t step = count / most_roots + 1;
  roots_.clear();
  std::size_t next = 0;
  float weight = 0.0F;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const auto& roots = objects_[i].hierarchy->data().roots;
    for (; next < roots.size(); next += step) {
      const float own = error_px(i, roots[next]);
      if (own > 0.0F) roots_.push_back({{i, roots[next]}, weight += own});
    }
    next -= roots.size();
  }
}

// The screen error of a node; 0 where refinement would cull it.
float Probe::error_px(std::uint32_t object, SplitId s) const {
  const Hierarchy& hierarchy = *objects_[object].hierarchy;
  hierarchy.require(s);
  const SplitNode& node = hierarchy.node(s);
  const ObjectView& view = views_[object];
  if (!view.may_be_inside(node.sphere)) return 0.0F;
  if (!objects_[object].two_sided && faces_away(node.cone(), node.sphere, view.eye())) return 0.0F;
  return std::min(ScreenError::in_pixels(node.error, view.largest_scale_px(node.sphere)), largest_error_px);
}

// From a root down to the last node whose error is not below the level. Errors fall with one over the number of
// triangles, so below a node are about as many nodes as its error is times the level. Each step therefore goes to a
// child with a probability in proportion to its error, which makes all last nodes about equally likely.
Probe::Sample Probe::walk(float level_px) {
  const float start = static_cast<float>(random()) * roots_.back().weight_until;
  const auto root = std::upper_bound(roots_.begin(), roots_.end() - 1, start,
                                     [](float value, const Root& r) { return value < r.weight_until; });
  Sample at = root->node;
  at.error_px = error_px(at.object, at.split);
  while (true) {
    const SplitNode& node = objects_[at.object].hierarchy->node(at.split);
    const float u = node.child_u == no_id ? 0.0F : error_px(at.object, node.child_u);
    const float v = node.child_v == no_id ? 0.0F : error_px(at.object, node.child_v);
    const bool to_u = random() * static_cast<double>(u + v) < static_cast<double>(u);
    const float error = to_u ? u : v;
    // Ids rise along the forest, also in a corrupt file, so every walk ends.
    const SplitId next = to_u ? node.child_u : node.child_v;
    if (!(error > 0.0F && error >= level_px) || next <= at.split) return at;
    at.split = next;
    at.error_px = error;
  }
}

// A walk that ended far above the level, because everything below is culled or the mesh ends, stands in for walks to
// nodes that do not exist: it counts less.
void Probe::count(const Sample& at, float level_px) {
  const Hierarchy& hierarchy = *objects_[at.object].hierarchy;
  Sums& sums = sums_[at.object];
  const SplitNode& node = hierarchy.node(at.split);
  const double weight = std::min(1.0, static_cast<double>(level_px) / std::max(at.error_px, level_px));
  ++sums.samples;
  sums.visits += weight;
  const float priority = importances_[at.object].of(at.split).priority;
  const bool is_split = priority > 0.0F && priority >= level_px;
  // Bounds contain the star, and the parent's bounds contain both: what is visible is visible above.
  if (is_split) {
    ++sums.split_samples;
    sums.splits += weight;
    if (!visibility_->hides({at.object, PointHull{star_.points(hierarchy, at.split)}})) {
      sums.seen += weight;
      sums.below += weight * static_cast<double>(nodes_below(at.object, at.split, 0.5F * level_px, most_below));
      return;
    }
    sums.stars_hidden += weight;
  }
  if (!visibility_->hides({at.object, node.box()})) return;
  if (is_split) sums.splits_hidden += weight;
  if (node.parent != no_id && visibility_->hides({at.object, hierarchy.node(node.parent).box()}))
    sums.visits_hidden += weight;
}

// No more than `most` of them.
std::size_t Probe::nodes_below(std::uint32_t object, SplitId s, float least_px, std::size_t most) const {
  const SplitNode& node = objects_[object].hierarchy->node(s);
  std::size_t count = 0;
  for (const SplitId child : {node.child_u, node.child_v}) {
    if (count >= most || child == no_id || child <= s) continue;
    const float error = error_px(object, child);
    if (error > 0.0F && error >= least_px) count += 1 + nodes_below(object, child, least_px, most - count - 1);
  }
  return count;
}

// SplitMix64 (Steele, Lea, Flood 2014), in [0, 1).
double Probe::random() {
  state_ += 0x9e3779b97f4a7c15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27U)) * 0x94d049bb133111ebULL;
  z ^= z >> 31U;
  return static_cast<double>(z >> 11U) * 0x1p-53;
}

}  // namespace occlod
