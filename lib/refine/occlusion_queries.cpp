#include "refine/occlusion_queries.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <string>

#include "base/platform.h"
#include "base/threads.h"
#include "base/timing.h"
#include "occlod/base.h"
#include "refine/star_visibility.h"
#include "refine/tuning.h"
#include "splits/star.h"

namespace occlod {

RegionGrid::RegionGrid(const Box& box) : min_(box.min) {
  constexpr auto cells = static_cast<float>(effect_regions_per_axis);
  for (int axis = 0; axis < 3; ++axis) {
    const float extent = box.max[axis] - box.min[axis];
    cells_per_unit_[axis] = extent > 0.0F ? cells / extent : 0.0F;
  }
}

void EffectGate::begin(std::span<const RefineObject> objects, const RefineOptions& options) {
  if (!options.effects.empty() && options.effects.size() != objects.size())
    throw Error({"effects", "", "are given for " + std::to_string(options.effects.size()) + " objects",
                 "give none or one for each of " + std::to_string(objects.size())});
  objects_.clear();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const ObjectEffects effects = options.effects.empty() ? ObjectEffects{} : options.effects[i];
    objects_.push_back({RegionGrid(objects[i].hierarchy->box()), effects.occlusion ? effects.regions : 0,
                        effects.cones && !objects[i].two_sided});
  }
  stats_.assign(objects.size(), {});
}

namespace {

constexpr std::size_t min_at_once = 128;

}  // namespace

void OcclusionQueries::begin(Visibility& visibility, const QueriedScene& scene) {
  visibility_ = &visibility;
  scene_ = scene;
  counts_ = {};
  const Clock::time_point start = Clock::now();
  visibility_->set_threads(scene.threads);
  visibility_->begin_view(*scene.view, scene.views);
  can_hide_ = visibility_->can_hide();
  flight_ = visibility_->flight();
  milliseconds_ = milliseconds_since(start);
}

bool OcclusionQueries::asks(const Entry& entry) const {
  const RefineOptions* const options = scene_.options;
  if (entry.kind == Entry::Kind::apply
          ? !asks_stars()
          : entry.level % tuning_of(*options).level_step != tuning_of(*options).level_step - 1)
    return false;
  return asks_in_region(entry.object, entry.split);
}

bool OcclusionQueries::asks_in_region(std::uint32_t object, SplitId s) const {
  return asks_everywhere(object) || scene_.gate->asks(object, scene_.cuts->hierarchy(object).node(s).sphere.center);
}

bool OcclusionQueries::asks_stars() const {
  const RefineOptions* const options = scene_.options;
  return tuning_of(*options).culling == Culling::star && tuning_of(*options).ask_stars;
}

bool OcclusionQueries::asks_splits() const {
  const RefineOptions* const options = scene_.options;
  return tuning_of(*options).culling == Culling::subtree || asks_stars();
}

Entry::Kind OcclusionQueries::split_question() const {
  const RefineOptions* const options = scene_.options;
  return tuning_of(*options).culling == Culling::star ? Entry::Kind::apply : Entry::Kind::visit;
}

void OcclusionQueries::ask(std::span<const Entry> entries, std::span<Verdict> verdicts) {
  constexpr std::size_t block = 4 * min_at_once;
  const Clock::time_point start = Clock::now();
  const unsigned threads = many_threads_may_ask() ? scene_.threads : 1;
  if (scratch_.size() < threads) scratch_.resize(threads);
  if (threads > 1)
    for_each_block(entries.size(), block, threads, [&](std::size_t begin, std::size_t end, unsigned thread) {
      find(entries.subspan(begin, end - begin), verdicts.subspan(begin, end - begin), scratch_[thread]);
    });
  else
    find(entries, verdicts, scratch_[0]);
  count(entries, verdicts, milliseconds_since(start));
}

// Asks in pieces that stay in the cache: tests vertices, which decide most questions, then asks about bounds, then
// looks again at the vertices of stars that are visible all the same.
void OcclusionQueries::find(std::span<const Entry> entries, std::span<Verdict> verdicts, Scratch& scratch) const {
  const std::size_t max_at_once = std::max(min_at_once, flight_);
  const RefineOptions* const options = scene_.options;
  const bool looks_for_covered = visibility_->tests_points() && tuning_of(*options).covered_factor < 1.0;
  for (std::size_t first = 0; first < entries.size(); first += max_at_once) {
    const std::size_t size = std::min(max_at_once, entries.size() - first);
    find_vertices_that_show(entries.subspan(first, size), verdicts.subspan(first, size), scratch);
    ask_about_bounds(entries.subspan(first, size), verdicts.subspan(first, size), scratch);
    if (looks_for_covered) find_covered(entries.subspan(first, size), verdicts.subspan(first, size), scratch);
  }
}

void OcclusionQueries::count(std::span<const Entry> entries, std::span<const Verdict> verdicts, double milliseconds) {
  milliseconds_ += milliseconds;
  counts_.asked += entries.size();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (!verdicts[i].visible) ++counts_.hidden;
    scene_.gate->answered(entries[i].object, entries[i].kind, verdicts[i].region, entries[i].error.quadric_px,
                          verdicts[i].visible);
  }
}

void OcclusionQueries::find_vertices_that_show(std::span<const Entry> entries, std::span<Verdict> verdicts,
                                               Scratch& scratch) const {
  scratch.vertices.resize(entries.size());
  scratch.vertex_shows.resize(entries.size());
  for (const Entry& entry : entries) {
    const Hierarchy& hierarchy = scene_.cuts->hierarchy(entry.object);
    prefetch(&hierarchy.positions()[hierarchy.vertex_of(entry.split)]);
    prefetch(&hierarchy.node(entry.split));
  }
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Hierarchy& hierarchy = scene_.cuts->hierarchy(entries[i].object);
    scratch.vertices[i] = hierarchy.positions()[hierarchy.vertex_of(entries[i].split)];
  }
  for (std::size_t first = 0, end = 0; first < entries.size(); first = end) {
    while (end < entries.size() && entries[end].object == entries[first].object) ++end;
    visibility_->find_visible_points(entries[first].object, std::span(scratch.vertices).subspan(first, end - first),
                                     std::span(scratch.vertex_shows).subspan(first, end - first));
  }
  for (std::size_t i = 0; i < entries.size(); ++i)
    verdicts[i] = {true, scratch.vertex_shows[i] != 0, false, region_of(entries[i])};
}

std::uint8_t OcclusionQueries::region_of(const Entry& entry) const {
  static_assert(effect_region_count <= 256);
  const glm::vec3& center = scene_.cuts->hierarchy(entry.object).node(entry.split).sphere.center;
  return static_cast<std::uint8_t>(scene_.gate->region_of(entry.object, center));
}

void OcclusionQueries::prefetch_star(const Entry& entry) const noexcept {
  const Hierarchy& hierarchy = scene_.cuts->hierarchy(entry.object);
  prefetch(hierarchy.data().stars.data() + hierarchy.node(entry.split).star);
}

// Prefetches the corners of a split's star. The star should be in the caches already.
void OcclusionQueries::prefetch_corners(const Entry& entry) const noexcept {
  const Hierarchy& hierarchy = scene_.cuts->hierarchy(entry.object);
  const SplitStar star = star_of(hierarchy, entry.split);
  if (!star.is_fan()) return;
  for (const VertexId v : star.ring()) prefetch(hierarchy.positions().data() + v);
}

// Asks about those whose vertices do not show.
void OcclusionQueries::ask_about_bounds(std::span<const Entry> entries, std::span<Verdict> verdicts,
                                        Scratch& scratch) const {
  auto& [vertices, vertex_shows, asked, first_points, points, queries, answers] = scratch;
  asked.clear();
  points.clear();
  first_points.clear();
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (verdicts[i].vertex_shows) continue;
    asked.push_back(i);
    if (entries[i].kind == Entry::Kind::apply) prefetch_star(entries[i]);
  }
  if (asked.empty()) return;
  constexpr std::size_t ahead = 4;  // stars do not lie in the order of questions, nor do their corners
  for (std::size_t k = 0; k < asked.size(); ++k) {
    if (k + ahead < asked.size() && entries[asked[k + ahead]].kind == Entry::Kind::apply)
      prefetch_corners(entries[asked[k + ahead]]);
    const Entry& entry = entries[asked[k]];
    first_points.push_back(points.size());
    if (entry.kind == Entry::Kind::apply)
      StarVisibility::append_points(scene_.cuts->hierarchy(entry.object), entry.split, points);
  }
  first_points.push_back(points.size());
  queries.clear();
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const Entry& entry = entries[asked[k]];
    if (entry.kind == Entry::Kind::apply)
      queries.push_back(
          {entry.object, PointHull{std::span(points).subspan(first_points[k], first_points[k + 1] - first_points[k])}});
    else
      queries.push_back(query_about(entry));
  }
  answers.resize(asked.size());
  visibility_->answer(queries, answers);
  for (std::size_t k = 0; k < asked.size(); ++k) verdicts[asked[k]].visible = answers[k] != 0;
}

namespace {

// Moves the first corner towards the eye until it is as near as the nearest of the corners: what hides this point is
// before all of them, so it is not their own surface.
glm::vec3 drawn_near(std::span<const glm::vec3> corners, const ObjectView& view) {
  const glm::vec3 into_image(view.planes()[4]), &vertex = corners.front(), to_eye = view.eye() - vertex;
  float farther = 0.0F;  // than the nearest corner
  for (const glm::vec3& corner : corners) farther = std::max(farther, glm::dot(into_image, vertex - corner));
  const float eye_nearer = -glm::dot(into_image, to_eye);
  return farther < eye_nearer ? vertex + farther / eye_nearer * to_eye : vertex;
}

}  // namespace

// Follows ask_about_bounds() with the same arguments.
void OcclusionQueries::find_covered(std::span<const Entry> entries, std::span<Verdict> verdicts,
                                    Scratch& scratch) const {
  auto& [vertices, vertex_shows, asked, first_points, points, queries, answers] = scratch;
  vertices.clear();
  std::size_t kept = 0;
  for (std::size_t k = 0; k < asked.size(); ++k) {
    const Entry& entry = entries[asked[k]];
    if (entry.kind != Entry::Kind::apply || !verdicts[asked[k]].visible) continue;
    const std::span<const glm::vec3> corners =
        std::span(points).subspan(first_points[k], first_points[k + 1] - first_points[k]);
    vertices.push_back(drawn_near(corners, scene_.views[entry.object]));
    asked[kept++] = asked[k];
  }
  asked.resize(kept);
  vertex_shows.resize(kept);
  for (std::size_t first = 0, end = 0; first < kept; first = end) {
    const std::uint32_t object = entries[asked[first]].object;
    while (end < kept && entries[asked[end]].object == object) ++end;
    visibility_->find_visible_points(object, std::span(vertices).subspan(first, end - first),
                                     std::span(vertex_shows).subspan(first, end - first));
  }
  for (std::size_t k = 0; k < kept; ++k) verdicts[asked[k]].covered = vertex_shows[k] == 0;
}

// Returns a query about the bounds of the entry's subtree.
VisibilityQuery OcclusionQueries::query_about(const Entry& entry) const {
  const SplitNode& node = scene_.cuts->hierarchy(entry.object).node(entry.split);
  const RefineOptions* const options = scene_.options;
  switch (tuning_of(*options).proxy) {
    case Proxy::sphere:
      return {entry.object, node.sphere};
    case Proxy::cylinder:
      return {entry.object, node.cylinder()};
    case Proxy::box:
      break;
  }
  return {entry.object, node.box()};
}

void OcclusionQueries::draw_occluder(CutSet& cuts) {
  const RefineOptions* const options = scene_.options;
  const std::span<const OccluderPart> parts =
      occluder_.build(scene_.objects, cuts, *scene_.view, scene_.views, options->mode, scene_.threads);
  const Clock::time_point start = Clock::now();
  visibility_->draw_occluder(parts);
  milliseconds_ += milliseconds_since(start);
  ++counts_.draws;
}

}  // namespace occlod
