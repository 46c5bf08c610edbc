// Every backend on the same random bounds in random views of generated scenes: against rays, and against each other.
// What rays can say is in oracle/ray_oracle.h; what each backend may differ by is in docs/internals/occlusion.md.
#include <algorithm>
#include <map>

#include "gl/backends.h"
#include "oracle/judge.h"

namespace occlod::gl {
namespace {

using test::JudgedBound;
using test::SceneKind;
using test::Tally;

constexpr int view_count = 40;
constexpr int bounds_per_view = 150;

struct Judged {
  std::vector<std::string> names;  // of backends; "none" is the first
  std::vector<JudgedBound> bounds;

  // Its place, if the machine has it.
  [[nodiscard]] std::optional<std::size_t> find(const TestedBackend& tested) const {
    const auto found = std::find(names.begin(), names.end(), tested.label());
    if (found == names.end()) return std::nullopt;
    return static_cast<std::size_t>(found - names.begin());
  }
};

// Computed once for a scene.
const Judged& judged(SceneKind scene) {
  static std::map<SceneKind, Judged> known;
  const auto [entry, is_new] = known.try_emplace(scene);
  Judged& result = entry->second;
  if (!is_new) return result;
  std::vector<std::unique_ptr<Visibility>> backends;
  result.names.emplace_back("none");
  backends.push_back(std::make_unique<NoOcclusion>());
  for (const TestedBackend& tested : tested_backends()) {
    std::string why;
    const std::shared_ptr<Context> context = tested.context(why);
    if (!context && tested.backend != Backend::software) continue;
    result.names.push_back(tested.label());
    backends.push_back(tested.make(context));
  }
  result.bounds = test::judge(scene, backends, view_count, bounds_per_view);
  return result;
}

// The largest shares of all bounds that only one of two backends may hide.
struct Allowed {
  double only_first;
  double only_second;
};

class RandomVerdicts : public testing::TestWithParam<SceneKind> {
 protected:
  // Nothing where the machine lacks one of them.
  void expect(const TestedBackend& first, const TestedBackend& second, const Allowed& allowed) const {
    const std::optional<std::size_t> a = all_.find(first), b = all_.find(second);
    if (!a || !b) return;
    int both = 0, only_first = 0, only_second = 0, forbidden = 0;
    for (const JudgedBound& bound : all_.bounds) {
      const bool first_hides = !bound.shown[*a], second_hides = !bound.shown[*b];
      both += first_hides && second_hides ? 1 : 0;
      only_first += first_hides && !second_hides ? 1 : 0;
      only_second += second_hides && !first_hides ? 1 : 0;
      forbidden += first_hides != second_hides && bound.must_show ? 1 : 0;
    }
    const auto count = static_cast<double>(all_.bounds.size());
    EXPECT_GT(both, 50) << first << " " << second;  // else nothing was tested
    EXPECT_LE(only_first, allowed.only_first * count) << first << " " << second;
    EXPECT_LE(only_second, allowed.only_second * count) << first << " " << second;
    EXPECT_EQ(forbidden, 0) << first << " " << second;
  }

  const Judged& all_ = judged(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Gl, RandomVerdicts, testing::ValuesIn(test::scene_kinds),
                         [](const auto& param) { return test::label(param.param); });

// A point that a ray finds in front of the occluder is in front whatever the backend: hiding it takes something visible
// away.
TEST_P(RandomVerdicts, NothingThatRaysSeeIsHidden) {
  for (std::size_t i = 0; i < all_.names.size(); ++i) {
    const Tally tally = test::tally(all_.bounds, i);
    if (!tally.wrong.empty())
      ADD_FAILURE() << all_.names[i] << " hides " << tally.wrong.size() << " bounds, first " << tally.wrong.front();
    EXPECT_GT(tally.must_show, 1000);  // else nothing was tested
  }
}

// What rays find hidden may be shown, since bounds are grown and have one nearest depth, but then occlusion finds
// nothing. Floors are about nine tenths of what was measured: grown proxies lose most where gaps are as narrow as they
// grow (pipes), and three pixels are more than one.
TEST_P(RandomVerdicts, MostOfWhatRaysFindHiddenIsFound) {
  const bool narrow_gaps = GetParam() == SceneKind::pipes;
  for (std::size_t i = 0; i < all_.names.size(); ++i) {
    const Tally tally = test::tally(all_.bounds, i);
    const auto is = [&](const char* part) { return all_.names[i].find(part) != std::string::npos; };
    const double floor = is("none")       ? 0.0
                         : is("software") ? 0.8
                         : is("half")     ? (narrow_gaps ? 0.2 : 0.6)
                         : is("third")    ? (narrow_gaps ? 0.15 : 0.5)
                                          : (narrow_gaps ? 0.4 : 0.7);
    EXPECT_GE(tally.found, floor * tally.hidden) << all_.names[i] << " finds " << tally.found << " of " << tally.hidden;
    EXPECT_GT(tally.hidden, 150);  // else nothing was tested
    EXPECT_TRUE(!is("none") || tally.found == 0);
    RecordProperty(all_.names[i], std::to_string(tally.found) + " of " + std::to_string(tally.hidden) + ", " +
                                      std::to_string(tally.seen_between) + " seen between pixel centres");
  }
}

// How much two backends that the machine has may differ, by docs/internals/occlusion.md. Where they do, the one that
// hides is not contradicted by rays.
TEST_P(RandomVerdicts, BackendsAgreeAsFarAsTheyPromise) {
  for (const Platform platform : {Platform::egl, Platform::osmesa}) {
    SCOPED_TRACE(platform_label(platform));
    // The driver may say visible where nothing is, never the other way round.
    expect({Backend::query, platform}, {Backend::query_conservative, platform}, {1.0, 0.0});
    // Where the full target has a sample that passes, at most half a diagonal of a larger pixel from a sample of the
    // smaller target, the proxy grown by that much more passes there: at that depth the smaller target holds nothing
    // nearer.
    expect({Backend::query, platform}, {Backend::query_half, platform}, {1.0, 0.0});
    expect({Backend::query, platform}, {Backend::query_third, platform}, {1.0, 0.0});
    // Volumes grown by 3/4 pixel against exact rectangles of whole pixels with one nearest depth: either may see more.
    expect({Backend::software, platform}, {Backend::query, platform}, {0.1, 0.01});
  }
  // One driver behind both on most machines; where EGL finds a GPU, edges of proxies may differ.
  for (const Backend backend : {Backend::query, Backend::query_half, Backend::query_third})
    expect({backend, Platform::egl}, {backend, Platform::osmesa}, {0.01, 0.01});
}

}  // namespace
}  // namespace occlod::gl
