// Random bounds against random occluders: every backend against rays, and the backends against each other.
#include <array>

#include "gl/backends.h"
#include "gl/ray_oracle.h"

namespace occlod::gl {
namespace {

constexpr std::array<ProxyShape, 3> all_shapes{ProxyShape::sphere, ProxyShape::box, ProxyShape::cylinder};

class BackendRandom : public EachBackend {};
INSTANTIATE_TEST_SUITE_P(Gl, BackendRandom, testing::ValuesIn(tested_backends()), backend_label);

// In front for certain: visible. Behind everything for certain: hidden. Asked in portions of 25, so that those which
// answer together answer for each.
TEST_P(BackendRandom, NeverHidesWhatARayFindsInFront) {
  const auto occlusion = make();
  std::mt19937 random(29);
  int visible = 0;
  int hidden = 0;
  for (int scene = 0; scene < 24; ++scene) {
    RandomScene bounds(view_, random);
    start(*occlusion, bounds.soup(), bounds.transform());
    for (int portion = 0; portion < 6; ++portion) {
      std::vector<Verdict> expected;
      for (int i = 0; i < 25; ++i) {
        const VisibilityQuery query = bounds.next_bound(all_shapes[random() % 3U]);
        expected.push_back(bounds.verdict(query));
        occlusion->submit(query);
      }
      for (std::size_t i = 0; i < expected.size(); ++i) {
        const std::uint32_t answer = occlusion->collect();
        visible += expected[i].must_be_visible ? 1 : 0;
        hidden += expected[i].must_be_hidden ? 1 : 0;
        if (expected[i].must_be_visible) {
          ASSERT_NE(answer, 0U) << "scene " << scene << " bound " << 25 * portion + static_cast<int>(i);
        } else if (expected[i].must_be_hidden) {
          EXPECT_EQ(answer, 0U) << "scene " << scene << " bound " << 25 * portion + static_cast<int>(i);
        }
      }
    }
  }
  // The test must have tested something: of 3,600 bounds many are in front and many behind.
  EXPECT_GT(visible, 500);
  EXPECT_GT(hidden, 100);
  RecordProperty("visible", visible);
  RecordProperty("hidden", hidden);
}

// Two backends on the same 3,600 bounds.
class BackendPairs : public testing::TestWithParam<Platform> {
 protected:
  struct Tally {
    int both_hide = 0;
    int only_first_hides = 0;
    int only_second_hides = 0;
    int decided = 0;  // of those that only one hides, where rays are certain about the answer
  };
  // Nothing where the machine lacks one of them.
  std::optional<Tally> compare(Backend first, Backend second) {
    const std::array<TestedBackend, 2> tested{TestedBackend{first, GetParam()}, TestedBackend{second, GetParam()}};
    std::array<std::unique_ptr<Visibility>, 2> pair;
    for (std::size_t i = 0; i < 2; ++i) {
      std::string why;
      const std::shared_ptr<Context> context = tested[i].context(why);
      if (!context && tested[i].backend != Backend::software) return std::nullopt;
      pair[i] = tested[i].make(context);
    }
    Tally tally;
    std::mt19937 random(31);
    for (int scene = 0; scene < 24; ++scene) {
      RandomScene bounds(view_, random);
      const std::array<ObjectView, 1> objects{ObjectView(view_, bounds.transform())};
      const std::array<OccluderPart, 1> parts{bounds.soup().part()};
      for (const auto& one : pair) {
        one->begin_view(view_, objects);
        one->draw_occluder(parts);
      }
      for (int i = 0; i < 150; ++i) {
        const VisibilityQuery query = bounds.next_bound(all_shapes[random() % 3U]);
        for (const auto& one : pair) one->submit(query);
        const bool first_hides = pair[0]->collect() == 0;
        const bool second_hides = pair[1]->collect() == 0;
        tally.both_hide += first_hides && second_hides ? 1 : 0;
        tally.only_first_hides += first_hides && !second_hides ? 1 : 0;
        tally.only_second_hides += !first_hides && second_hides ? 1 : 0;
        const Verdict certain = bounds.verdict(query);
        if (first_hides != second_hides && (certain.must_be_visible || certain.must_be_hidden)) ++tally.decided;
      }
    }
    return tally;
  }

  View view_ = test_view();
};
INSTANTIATE_TEST_SUITE_P(Gl, BackendPairs, testing::Values(Platform::egl, Platform::osmesa),
                         [](const auto& param) { return platform_label(param.param); });

// The same proxies against the same depth buffer.
TEST_P(BackendPairs, MarksAnswerAsQueries) {
  const auto tally = compare(Backend::query, Backend::mark);
  if (!tally) GTEST_SKIP() << "no context";
  EXPECT_GT(tally->both_hide, 500);
  EXPECT_EQ(tally->only_first_hides + tally->only_second_hides, 0);
}

// The driver may say visible where nothing is, never the other way round.
TEST_P(BackendPairs, ConservativeQueriesHideNoMore) {
  const auto tally = compare(Backend::query, Backend::query_conservative);
  if (!tally) GTEST_SKIP() << "no context";
  EXPECT_GT(tally->both_hide, 500);
  EXPECT_EQ(tally->only_second_hides, 0);
}

// Where the full target has a sample that passes, at most half a diagonal of a larger pixel from a sample of the
// smaller target, the proxy grown by that much more passes there: at that depth the smaller target holds nothing
// nearer.
TEST_P(BackendPairs, SmallerTargetsHideNoMore) {
  for (const auto& [full, smaller] :
       {std::pair(Backend::query, Backend::query_half), {Backend::mark, Backend::mark_third}}) {
    const auto tally = compare(full, smaller);
    if (!tally) GTEST_SKIP() << "no context";
    EXPECT_GT(tally->both_hide, 400);
    EXPECT_GT(tally->only_first_hides, 0);  // the price
    EXPECT_EQ(tally->only_second_hides, 0);
  }
}

// The same rectangles and depths against occluders that differ by 1/64 of a pixel: another answer for one bound of a
// hundred at most, and only where rays leave both open.
TEST_P(BackendPairs, ComputeAnswersAsSoftware) {
  const auto tally = compare(Backend::software, Backend::compute);
  if (!tally) GTEST_SKIP() << "no context";
  EXPECT_GT(tally->both_hide, 500);
  EXPECT_LE(tally->only_first_hides + tally->only_second_hides, 36);
  EXPECT_EQ(tally->decided, 0);
  RecordProperty("only_software_hides", tally->only_first_hides);
  RecordProperty("only_compute_hides", tally->only_second_hides);
}

}  // namespace
}  // namespace occlod::gl
