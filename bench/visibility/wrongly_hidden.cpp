// Pixels that occlusion hides wrongly, over many views.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "accuracy.h"
#include "option_names.h"
#include "stopwatch.h"
#include "visibility/subjects.h"
#include "visibility/views.h"

namespace occlod::bench {
namespace {

using tool::Json;

constexpr std::uint64_t seed = 1;
constexpr int max_tries_a_view = 20;
constexpr std::array modes = {OccluderMode::paper, OccluderMode::conservative};

// What came of all views of one scene in one mode.
struct Tally {
  std::size_t views_with = 0;
  std::size_t sum = 0;
  std::size_t largest = 0;
  double largest_allowed_px = 0.0;

  void add(std::size_t pixels, double allowed_px) {
    views_with += pixels > 0 ? 1U : 0U;
    sum += pixels;
    largest = std::max(largest, pixels);
    largest_allowed_px = std::max(largest_allowed_px, allowed_px);
  }
};

class Hunt {
 public:
  Hunt(SceneRun& run, const VisibilityOptions& options, Table& found)
      : run_(run), options_(options), found_(found), counter_(run.objects) {}

  void look_everywhere() {
    RandomCameras cameras(run_, options_.hidden_size, seed);
    for (int tries = 0; random_ < options_.views && tries < options_.views * max_tries_a_view; ++tries)
      if (look({fmt::format("random {}", tries), cameras.next()})) ++random_;
    for (const NamedView& view : path_views(run_, options_.path_frames, options_.hidden_size))
      if (look(view)) ++on_paths_;
  }

  void add_rows(Table& table) const {
    for (std::size_t i = 0; i < modes.size(); ++i)
      table.add({{"scene", run_.description.name},
                 {"mode", tool::name_of(modes[i])},
                 {"random_views", random_},
                 {"path_views", on_paths_},
                 {"refused", refused_},
                 {"views_with_any", tallies_[i].views_with},
                 {"sum_px", tallies_[i].sum},
                 {"largest_px", tallies_[i].largest},
                 {"largest_allowed_px", tallies_[i].largest_allowed_px},
                 {"seconds", stopwatch_.milliseconds() / 1e3}});
  }

 private:
  // False when the view is not fair.
  bool look(const NamedView& named) {
    const View view(named.camera);
    RefineOptions refine;
    counter_.set_view(view, refine);
    if (!is_fair(run_, view, counter_.items(), counter_.drawn())) {
      ++refused_;
      return false;
    }
    for (std::size_t i = 0; i < modes.size(); ++i) {
      refine.mode = modes[i];
      const std::size_t pixels = counter_.count(refine, *run_.software);
      tallies_[i].add(pixels, counter_.allowed_px());
      if (pixels == 0) continue;
      found_.add({{"scene", run_.description.name},
                  {"mode", tool::name_of(modes[i])},
                  {"view", named.name},
                  {"pixels", pixels},
                  {"allowed_px", counter_.allowed_px()},
                  {"camera", tool::to_json(named.camera)}});
    }
    return true;
  }

  SceneRun& run_;
  const VisibilityOptions& options_;
  Table& found_;
  tool::WronglyHidden counter_;
  tool::Stopwatch stopwatch_;
  int random_ = 0;
  int on_paths_ = 0;
  int refused_ = 0;
  std::array<Tally, modes.size()> tallies_;
};

}  // namespace

Subject wrongly_hidden_subject(Table& views) {
  return {{"wrongly_hidden",
           "Pixels wrongly hidden when both sides refine to 1 px without a budget (software occlusion). Refused: views "
           "that "
           "show less than a twentieth of a picture of the scene, or the backs of one-sided faces. Allowed: the "
           "largest sum "
           "of the two promised errors, px.",
           {{"scene", "scene"},
            {"mode", "mode"},
            {"random_views", "random views"},
            {"path_views", "of paths"},
            {"refused", "refused"},
            {"views_with_any", "views with any"},
            {"sum_px", "sum, px"},
            {"largest_px", "largest, px"},
            {"largest_allowed_px", "allowed"},
            {"seconds", "s", 0}},
           {}},
          [&views](Table& table, SceneRun& run, const VisibilityOptions& options) {
            Hunt hunt(run, options, views);
            hunt.look_everywhere();
            hunt.add_rows(table);
          }};
}

Table wrongly_hidden_views() {
  return {"wrongly_hidden_views",
          "Views with wrongly hidden pixels; the camera as scenes have it:",
          {{"scene", "scene"},
           {"mode", "mode"},
           {"view", "view"},
           {"pixels", "pixels"},
           {"allowed_px", "allowed"},
           {"camera", "camera"}},
          {}};
}

}  // namespace occlod::bench
