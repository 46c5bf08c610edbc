#include "report/settings.h"

#include <fmt/format.h>

#include "refine/tuning.h"
#include "visibility/scene_run.h"
#include "visibility/table.h"

namespace occlod::bench {
namespace {

using S = Setting;

void choose_as_the_paper(S& setting) { setting.refine = refine_options(setting.refine.budget, Culling::subtree); }

constexpr const char* paper_flags = "--paper";

// Stops at a promised error; the budget only keeps it from the full mesh.
Change tolerance(double px) {
  constexpr std::size_t most = 100'000;
  return {fmt::format("{} px", px), fmt::format("--tolerance {} --budget {}", px, most), [px](S& s) {
            s.refine.tolerance_px = px;
            s.refine.budget = most;
          }};
}

Change steps(const std::string& name, const std::vector<std::uint32_t>& splits) {
  return {name, fmt::format("(occluder after {} splits)", name),
          [splits](S& s) { tune(s.refine).occluder_splits = splits; }};
}

Change levels(std::uint32_t step) {
  return {fmt::format("every {}", step), fmt::format("(subtrees asked on every {}. level)", step),
          [step](S& s) { tune(s.refine).level_step = step; }};
}

Change proxy(const std::string& name, Proxy proxy) {
  return {name, fmt::format("(proxy {})", name), [proxy](S& s) { tune(s.refine).proxy = proxy; }};
}

Change raster(int divisor) {
  return {fmt::format("1/{}", divisor), fmt::format("(occluder at 1/{} of the width and height)", divisor),
          [divisor](S& s) { s.raster_divisor = divisor; }};
}

Change free_to_slip() {
  return {"free to slip", "(\"attributes\": false in the scene)", [](S& s) { s.attributes = false; }};
}

void go_on(S& setting) { setting.frame_to_frame = true; }

constexpr const char* update_flags = "--path NAME --frame-to-frame";

Change work_limit(std::size_t changes) {
  return {fmt::format("{}", changes), fmt::format("--path NAME --frame-to-frame --max-changes {}", changes),
          [changes](S& s) {
            go_on(s);
            s.refine.max_changes = changes;
          }};
}

Change hysteresis(double part) {
  return {fmt::format("{}", part), fmt::format("--path NAME --frame-to-frame (hysteresis {})", part), [part](S& s) {
            go_on(s);
            tune(s.refine).hysteresis = part;
          }};
}

std::string joined(const std::string& a, const std::string& b) { return a.empty() || b.empty() ? a + b : a + " " + b; }

}  // namespace

const std::vector<Change>& series() {
  static const std::vector<Change> all = {
      {"occlod", "", [](S&) {}},
      {"occlod, frame to frame", update_flags, go_on},
      {"occlod, frame to frame, no occlusion", joined("--occlusion none", update_flags),
       [](S& s) {
         go_on(s);
         s.occlusion = false;
       }},
      {"occlod, no occlusion", "--occlusion none", [](S& s) { s.occlusion = false; }},
      {"occlod, conservative", "--conservative", [](S& s) { s.refine.mode = OccluderMode::conservative; }},
      {"paper's LOD", joined(paper_flags, "--occlusion none"),
       [](S& s) {
         choose_as_the_paper(s);
         s.occlusion = false;
       }},
      {"paper's LOD + occlusion", paper_flags, choose_as_the_paper},
  };
  return all;
}

const std::vector<Knob>& knobs() {
  static const std::vector<Knob> all = {
      {"work limit",
       "frame to frame, with no more splits and merges a frame",
       {work_limit(100), work_limit(300), work_limit(1'000)}},
      {"hysteresis",
       "frame to frame; by how much more a split must matter than one that is applied, to take its place, instead of "
       "0.05",
       {hysteresis(0.0), hysteresis(0.2)}},
      {"tolerance",
       "stop when no error in sight is promised to be larger",
       {tolerance(128), tolerance(64), tolerance(32), tolerance(16)}},
      {"occluder steps",
       "draw the occluder after so many splits instead of at parts of the budget",
       {steps("300", {300}), steps("300,2500", {300, 2500}), steps("300,1000,2500,5000", {300, 1000, 2500, 5000})}},
      {"levels",
       "ask about subtrees on every so many-th level instead of every second",
       {levels(1), levels(3), levels(4)}},
      {"proxy",
       "the bounds of a subtree that are asked about instead of boxes",
       {proxy("sphere", Proxy::sphere), proxy("cylinder", Proxy::cylinder)}},
      {"raster",
       "the occluder's resolution in parts of the picture's: what shows only between its samples may be hidden",
       {raster(2), raster(4)}},
      {"checks",
       "what is asked again when the occluder has changed",
       {{"no retest", "(no retest)", [](S& s) { tune(s.refine).retest_hidden = false; }},
        {"no final check", "(no final check)", [](S& s) { tune(s.refine).final_check = false; }}}},
      {"textures",
       "triangles go where the shape is wrong alone, however far texture coordinates, normals and colours slip",
       {free_to_slip()}},
  };
  return all;
}

std::vector<Setting> all_settings(const std::vector<std::size_t>& budgets, std::size_t knob_budget) {
  std::vector<Setting> settings;
  for (const Change& change : series())
    for (const std::size_t budget : budgets) {
      Setting setting;
      setting.name = fmt::format("{}, {}", change.name, cell(budget, 0));
      setting.series = change.name;
      setting.flags = joined(fmt::format("--budget {}", budget), change.flags);
      setting.refine.budget = budget;
      change.apply(setting);
      settings.push_back(setting);
    }
  for (const Knob& knob : knobs())
    for (const Change& change : knob.values) {
      Setting setting;
      setting.refine.budget = knob_budget;
      change.apply(setting);
      setting.knob = knob.name;
      setting.name = fmt::format("{} {}, {}", knob.name, change.name, cell(setting.refine.budget, 0));
      const bool has_budget = setting.refine.budget != knob_budget;
      setting.flags = has_budget ? change.flags : joined(fmt::format("--budget {}", knob_budget), change.flags);
      settings.push_back(setting);
    }
  return settings;
}

}  // namespace occlod::bench
