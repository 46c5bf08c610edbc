#include "refine/probe.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "base/platform.h"
#include "occlod/visibility.h"
#include "raster/clip.h"
#include "refine/forecast.h"
#include "refine/queue.h"
#include "refine/tuning.h"

namespace occlod {
namespace {

constexpr int image_divisor = 4;
constexpr std::size_t walks_ahead = 128;
constexpr std::size_t walks_back = 512;  // more than ahead: looks back are rarer and decide for longer
constexpr std::size_t max_roots = 256;   // limits the roots that are sampled in scenes of thousands of components
constexpr double max_finer = 16.0;       // a walk ends at a node that stands for more nodes than this many budgets
constexpr std::uint32_t no_levels = 1U << 30U;  // no forest is this deep, so nothing is asked
constexpr std::size_t max_counted = 2048;  // about as many triangles are measured to know how much they fill the image
constexpr float min_level_px = 1e-3F;      // level of a fully refined mesh
constexpr float largest_error_px = 1e4F;   // error of nodes whose bounds contain the eye

Camera smaller(Camera camera) {
  camera.width = std::max(1, camera.width / image_divisor);
  camera.height = std::max(1, camera.height / image_divisor);
  return camera;
}

// Returns part / whole, or 0 if `whole` is 0.
double share(double part, double whole) { return whole > 0.0 ? part / whole : 0.0; }

}  // namespace

// Serves the refiner as its backend: draws occluders into a smaller image and answers every query with visible.
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
    coverage_ = coverage_of(parts);
  }
  void submit(const VisibilityQuery& /*query*/) override {}
  [[nodiscard]] std::uint32_t collect() override { return 1; }

  [[nodiscard]] bool drawn() const { return drawn_; }
  [[nodiscard]] const Coverage& coverage() const { return coverage_; }
  [[nodiscard]] bool hides(const VisibilityQuery& query) {
    software_->submit(query);
    return software_->collect() == 0;
  }

 private:
  [[nodiscard]] Coverage coverage_of(std::span<const OccluderPart> parts) const {
    std::size_t triangles = 0;
    for (const OccluderPart& part : parts) triangles += part.triangles.size();
    MeshFragments sum;
    for (const OccluderPart& part : parts) {
      const MeshFragments one = count_fragments(part.positions, part.triangles, views_[part.object],
                                                objects_[part.object].two_sided, triangles / max_counted + 1);
      sum.all += one.all;
      sum.front += one.front;
    }
    return {sum.all.layers, sum.front.layers, share(sum.front.triangles, sum.all.triangles)};
  }

  std::span<const RefineObject> objects_;
  std::unique_ptr<Visibility> software_ = make_software_occlusion();
  std::vector<ObjectView> views_;
  bool drawn_ = false;
  Coverage coverage_;
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
  coarse.budget = std::min(options.budget, scout_.base_triangles() + coarse_triangles);
  Tuning& tuning = tune(coarse);
  tuning.occluder_splits.clear();
  tuning.retest_hidden = tuning.final_check = tuning.ask_stars = false;
  tuning.level_step = no_levels;
  coarse.effects = {};
  (void)scout_.refine(view, coarse, *visibility_);
  begin(view, options);
  result_.all.coverage = visibility_->coverage();
  take_walks(walks_ahead, max_finer * static_cast<double>(options.budget));
  level_ahead_px_ = level_of(options.budget);
  if (visibility_->drawn()) count_walks(level_ahead_px_);
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
  result_.all.coverage = visibility_->coverage();
  take_walks(walks_back, max_finer * static_cast<double>(options.budget));
  count_walks(level_px);
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
}

// Takes evenly spread walks, which go on below the level at which the budget ends, to nodes that stand for more than
// max_nodes. All walks take a step in turn, so that many nodes, which are anywhere in memory, are fetched at a time.
void Probe::take_walks(std::size_t walks, double max_nodes) {
  find_roots();
  walks_.clear();
  if (roots_.empty()) return;
  paths_.resize(std::max(paths_.size(), walks));
  for (std::size_t i = 0; i < walks; ++i) {
    walks_.push_back(begin_walk((static_cast<double>(i) + 0.5) / static_cast<double>(walks)));
    paths_[i].assign({walks_[i].at});
  }
  active_.resize(walks);
  std::iota(active_.begin(), active_.end(), std::size_t{0});
  while (!active_.empty()) {
    for (const std::size_t i : active_) prefetch_children(walks_[i].at);
    std::erase_if(active_, [&](std::size_t i) {
      Walk& walk = walks_[i];
      if (walk.at.stands_for > max_nodes || !take_step(walk)) return true;
      paths_[i].push_back(walk.at);
      return false;
    });
  }
}

// Returns the error that this many nodes reach: each step counts as the nodes that it stands for (Knuth, "Estimating
// the efficiency of backtrack programs", 1975). Returns the smallest error found when there are fewer.
double Probe::level_of(std::size_t nodes) {
  sorted_.clear();
  for (std::size_t i = 0; i < walks_.size(); ++i) sorted_.insert(sorted_.end(), paths_[i].begin(), paths_[i].end());
  std::sort(sorted_.begin(), sorted_.end(), [](const Step& a, const Step& b) { return a.error_px > b.error_px; });
  double left = static_cast<double>(nodes) * static_cast<double>(walks_.size());
  for (const Step& step : sorted_)
    if ((left -= step.stands_for) <= 0.0) return static_cast<double>(step.error_px);
  return sorted_.empty() ? 0.0 : static_cast<double>(sorted_.back().error_px);
}

void Probe::count_walks(double level_px) {
  const float level = std::isfinite(level_px) ? std::max(static_cast<float>(level_px), min_level_px) : 1.0F;
  for (std::size_t i = 0; i < walks_.size(); ++i) count(paths_[i], level);
  Sums all;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    all.add(sums_[i]);
    result_.objects[i] = sums_[i].shares();
  }
  const Coverage coverage = result_.all.coverage;
  result_.all = all.shares();
  result_.all.coverage = coverage;
}

void Probe::Sums::add(const Sums& o) {
  samples += o.samples;
  split_samples += o.split_samples;
  visits += o.visits;
  visits_hidden += o.visits_hidden;
  splits += o.splits;
  splits_squared += o.splits_squared;
  splits_hidden += o.splits_hidden;
  stars_hidden += o.stars_hidden;
  seen += o.seen;
  seen_finer += o.seen_finer;
}

// Estimates the shares. Samples of very different weights are worth fewer equal ones (Kish). Some that found nothing
// hidden, and errors that fall with one over the number of splits, are added, so that few samples do not claim much.
HiddenShares Probe::Sums::shares() const {
  constexpr double added = 4.0;
  const double equal = share(splits * splits, splits_squared);
  const double trust = equal / (equal + added);
  HiddenShares result;
  result.visits = samples;
  result.splits = split_samples;
  result.visits_hidden = share(visits_hidden, visits);
  result.splits_hidden = trust * share(splits_hidden, splits);
  result.stars_hidden = trust * share(stars_hidden, splits);
  if (seen > 0.0) result.growth = std::lerp(result.growth, seen_finer / seen, trust);
  return result;
}

// Takes every n-th root of all forests, at most max_roots.
void Probe::find_roots() {
  std::size_t count = 0;
  for (const RefineObject& object : objects_) count += object.hierarchy->data().roots.size();
  const std::size_t step = count / max_roots + 1;
  root_step_ = static_cast<double>(step);
  roots_.clear();
  std::size_t next = 0;
  double weight = 0.0;
  for (std::uint32_t i = 0; i < objects_.size(); ++i) {
    const auto& roots = objects_[i].hierarchy->data().roots;
    for (; next < roots.size(); next += step) {
      const float own = error_px(i, roots[next]);
      if (own > 0.0F) roots_.push_back({{i, roots[next], own}, weight += std::sqrt(static_cast<double>(own))});
    }
    next -= roots.size();
  }
}

// Returns the screen error of a node; 0 where refinement would cull it.
float Probe::error_px(std::uint32_t object, SplitId s) const {
  const Hierarchy& hierarchy = *objects_[object].hierarchy;
  hierarchy.require(s);
  const SplitNode& node = hierarchy.node(s);
  const ObjectView& view = views_[object];
  if (!view.may_be_inside(node.sphere)) return 0.0F;
  if (!objects_[object].two_sided && faces_away(node.cone(), node.sphere, view.eye())) return 0.0F;
  return std::min(ScreenError::in_pixels(node.error, view.largest_scale_px(node.sphere)), largest_error_px);
}

// Begins a walk at a root. Errors fall with about one over the number of triangles, so the number of nodes of a given
// error below a node is proportional to the node's own error, or smaller where the mesh ends. So a walk begins at a
// root, and goes on to a child, with a probability in proportion to the square root of its error. `place`, in [0, 1),
// decides all its steps.
Probe::Walk Probe::begin_walk(double place) const {
  const double total = roots_.back().weight_until;
  const auto root = std::upper_bound(roots_.begin(), roots_.end() - 1, place * total,
                                     [](double value, const Root& r) { return value < r.weight_until; });
  const double before = root == roots_.begin() ? 0.0 : std::prev(root)->weight_until;
  const double weight = root->weight_until - before;
  Walk walk{root->node, (place * total - before) / weight};
  walk.at.stands_for = root_step_ * total / weight;
  return walk;
}

void Probe::prefetch_children(const Step& at) const {
  const Hierarchy& hierarchy = *objects_[at.object].hierarchy;
  const SplitNode& node = hierarchy.node(at.split);
  for (const SplitId child : {node.child_u, node.child_v})
    if (child < hierarchy.split_count()) prefetch(&hierarchy.node(child));
}

// Moves a walk to a child. Returns false at a leaf of the forest, and where everything below is culled.
bool Probe::take_step(Walk& walk) const {
  Step& at = walk.at;
  const SplitNode& node = objects_[at.object].hierarchy->node(at.split);
  const float u = node.child_u == no_id ? 0.0F : error_px(at.object, node.child_u);
  const float v = node.child_v == no_id ? 0.0F : error_px(at.object, node.child_v);
  const double weight_u = std::sqrt(static_cast<double>(u));
  const double share_u = share(weight_u, weight_u + std::sqrt(static_cast<double>(v)));
  const bool to_u = walk.place < share_u;
  const float error = to_u ? u : v;
  // Ids must rise along the forest, so every walk ends, even in a corrupt file.
  const SplitId next = to_u ? node.child_u : node.child_v;
  if (!(error > 0.0F) || next <= at.split) return false;
  const double probability = to_u ? share_u : 1.0 - share_u;
  walk.place = (to_u ? walk.place : walk.place - share_u) / probability;
  at.error_px = error;
  at.split = next;
  at.stands_for /= probability;
  return true;
}

// Counts the last node of a walk whose error is not below the level, as all nodes that it stands for, and of the splits
// on the way there the last one that is worth the level.
void Probe::count(std::span<const Step> path, float level_px) {
  std::size_t visited = 1;
  while (visited < path.size() && path[visited].error_px >= level_px) ++visited;
  Sums& sums = sums_[path.front().object];
  ++sums.samples;
  sums.visits += path[visited - 1].stands_for;
  std::size_t split = visited;
  while (split > 0 && !is_worth(path[split - 1], level_px)) --split;
  if (split > 0) count_split(path.subspan(split - 1), level_px, sums);
  count_visit(path[visited - 1], sums);
}

bool Probe::is_worth(const Step& step, float level_px) {
  const float priority = importances_[step.object].of(step.split).priority;
  return priority > 0.0F && priority >= level_px;
}

// Counts the first step.
void Probe::count_split(std::span<const Step> path, float level_px, Sums& sums) {
  const Step& at = path.front();
  const Hierarchy& hierarchy = *objects_[at.object].hierarchy;
  const double weight = at.stands_for;
  ++sums.split_samples;
  sums.splits += weight;
  sums.splits_squared += weight * weight;
  if (visibility_->hides({at.object, PointHull{star_.points(hierarchy, at.split)}})) {
    sums.stars_hidden += weight;
    // A node's bounds contain its star: what is visible is visible above.
    if (visibility_->hides({at.object, hierarchy.node(at.split).box()})) sums.splits_hidden += weight;
    return;
  }
  sums.seen += weight;
  sums.seen_finer += weight;
  for (const Step& below : path.subspan(1))
    if (below.error_px >= 0.5F * level_px && is_worth(below, 0.5F * level_px)) sums.seen_finer += below.stands_for;
}

// A node is not visited where the box of its parent is hidden.
void Probe::count_visit(const Step& at, Sums& sums) {
  const Hierarchy& hierarchy = *objects_[at.object].hierarchy;
  const SplitNode& node = hierarchy.node(at.split);
  if (node.parent != no_id && visibility_->hides({at.object, node.box()}) &&
      visibility_->hides({at.object, hierarchy.node(node.parent).box()}))
    sums.visits_hidden += at.stands_for;
}

}  // namespace occlod
