#include "oracle/judge.h"

#include <algorithm>

namespace occlod::test {
namespace {

constexpr std::size_t portion = 25;
constexpr int points_per_bound = 24;

struct Asked {
  VisibilityQuery bound;
  std::vector<glm::dvec3> points;
};

void ask(Visibility& backend, const RandomView& scene, std::span<const Asked> asked, std::span<JudgedBound> judged) {
  backend.begin_view(scene.view(), scene.objects());
  backend.draw_occluder(std::array{scene.occluder()});
  for (std::size_t first = 0; first < asked.size(); first += portion) {
    const std::size_t end = std::min(first + portion, asked.size());
    for (std::size_t i = first; i < end; ++i) backend.submit(asked[i].bound);
    for (std::size_t i = first; i < end; ++i) judged[i].shown.push_back(backend.collect() != 0);
  }
}

// What rays say. The dear question of certainty only where somebody hides what a ray sees.
void look(const RandomView& scene, const Asked& asked, JudgedBound& judged) {
  const RayOracle& rays = scene.rays();
  const Sight sight = rays.look(asked.bound, asked.points);
  const bool all_show = std::all_of(judged.shown.begin(), judged.shown.end(), [](bool shown) { return shown; });
  judged.hidden = sight.hidden();
  judged.must_show =
      (sight.at_eye || sight.visible > 0) && (all_show || rays.certainly_visible(asked.bound, asked.points));
  judged.seen_between =
      judged.hidden && std::any_of(asked.points.begin(), asked.points.end(),
                                   [&](const glm::dvec3& p) { return rays.is_seen(asked.bound.object, p); });
}

}  // namespace

std::vector<JudgedBound> judge(SceneKind scene, std::span<const std::unique_ptr<Visibility>> backends, int views,
                               int bounds) {
  const TriangleMesh mesh = scene_mesh(scene);
  RandomShapes random(17);
  std::vector<JudgedBound> all;
  for (int v = 0; v < views; ++v) {
    RandomView random_view(mesh, random);
    std::vector<Asked> asked(static_cast<std::size_t>(bounds));
    std::vector<JudgedBound> judged(asked.size());
    for (std::size_t i = 0; i < asked.size(); ++i) {
      asked[i].bound = random_view.next_bound();
      for (int k = 0; k < points_per_bound; ++k) asked[i].points.push_back(random.sample(asked[i].bound));
      judged[i].name = label(scene) + " view " + std::to_string(v) + " bound " + std::to_string(i) + " (" +
                       label(static_cast<BoundKind>(asked[i].bound.shape.index())) + ")";
    }
    for (const auto& backend : backends) ask(*backend, random_view, asked, judged);
    for (std::size_t i = 0; i < asked.size(); ++i) look(random_view, asked[i], judged[i]);
    std::move(judged.begin(), judged.end(), std::back_inserter(all));
  }
  return all;
}

Tally tally(std::span<const JudgedBound> judged, std::size_t backend) {
  Tally result;
  for (const JudgedBound& bound : judged) {
    const bool hides = !bound.shown[backend];
    result.must_show += bound.must_show ? 1 : 0;
    result.hidden += bound.hidden ? 1 : 0;
    result.found += bound.hidden && hides ? 1 : 0;
    result.seen_between += bound.seen_between && hides ? 1 : 0;
    if (bound.must_show && hides) result.wrong.push_back(bound.name);
  }
  return result;
}

}  // namespace occlod::test
