// Lists the settings of how HLODs are traversed and shown.
#include <vector>

#include "hlod_devices.h"
#include "hlod_strategies.h"
#include "setting_kinds.h"

namespace occlod::viewer {
namespace {

// Returns the names in the order of the enum.
std::vector<const char*> strategy_names() {
  std::vector<const char*> names;
  for (std::size_t i = 0; i < tool::strategies().size(); ++i)
    names.push_back(tool::name_of(static_cast<hlod::Strategy>(i)).c_str());
  return names;
}

}  // namespace

std::span<const Setting> hlod_settings() {
  static const std::vector<Setting> settings = {
      choice(
          {"open_as", "Open as",
           "Hierarchies of splits, or hierarchical levels of detail (HLOD); .ohlod files are HLODs anyway"},
          {"hierarchy", "hlod"}, [](auto& s) -> auto& { return s.load_as; }),
      choice(
          {"strategy", "Strategy", "Which nodes are drawn, and which occlusion queries decide it"}, strategy_names(),
          [](auto& s) -> auto& { return s.hlod.traverse.strategy; }),
      choice(
          {"other_strategy", "Compare with", "Split screen: strategy of its right half"}, strategy_names(),
          [](auto& s) -> auto& { return s.hlod.other_strategy; }),
      number(
          {"hlod_tolerance", "Tolerance", "Nodes whose error covers more pixels are refined; 0: the input itself"},
          {0.0, 64.0, false, "px"}, [](auto& s) -> auto& { return s.hlod.traverse.tolerance_px; }),
      not_kept(integer(
          {"most_triangles", "Most triangles",
           "The tolerance is raised until a frame has no more; 0: no limit. Where the CPU draws, it starts at 300,000"},
          {0, 10'000'000, true, ""}, [](auto& s) -> auto& { return s.hlod.most_triangles; })),
      number(
          {"bias_s", "Sigmoid (s)",
           "Bias of coh, batch and auto, by which errors count less where little of a node is visible: from the "
           "visible "
           "share itself (0) to a sigmoid of it (1)"},
          {0.0, 1.0, false, ""}, [](auto& s) -> auto& { return s.hlod.traverse.bias.s; }),
      number(
          {"bias_t", "Turning point (t)",
           "Bias: visible share of a node above which more than that share of its error counts; the smaller, the more "
           "is "
           "refined"},
          {0.0, 1.0, false, ""}, [](auto& s) -> auto& { return s.hlod.traverse.bias.t; }),
      choice(
          {"between", "Between levels",
           "geomorph: vertices slide to where the parent has them; within: nodes built with splits are refined within"},
          {"nothing", "geomorph", "within"}, [](auto& s) -> auto& { return s.hlod.between; }),
      choice(
          {"device", "Device", "What answers queries and is timed. gl: OpenGL; software: the rasteriser, exact"},
          {hlod_device_names.begin(), hlod_device_names.end()}, [](auto& s) -> auto& { return s.hlod.device; }),
      toggle(
          {"settle", "Draw until settled",
           "Draw more frames of a view that stands still until the same nodes are drawn; off: one"},
          [](auto& s) -> auto& { return s.hlod.settle; }),
      choice(
          {"hlod_color_by", "Colour by", "What the colour of a node stands for"},
          {"plain", "vertices", "texture", "level", "error", "bias", "state", "patch"},
          [](auto& s) -> auto& { return s.hlod.color_by; }),
      choice(
          {"node_boxes", "Boxes",
           "drawn: boxes of the nodes that are drawn; asked: of those that were asked about, by what came of it"},
          {"none", "drawn", "asked"}, [](auto& s) -> auto& { return s.hlod.boxes; }),
  };
  return settings;
}

}  // namespace occlod::viewer
