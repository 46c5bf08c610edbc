#include "hlod_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "option_values.h"

namespace occlod::tool {
namespace {

std::optional<double> share(const std::string& text) {
  double value = 0.0;
  if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value) || value < 0.0 || value > 1.0) return {};
  return value;
}

// "S,T", or "none".
void set_bias(hlod::TraverseOptions& options, const std::string& text) {
  options.biased = text != "none";
  if (!options.biased) return;
  const std::size_t comma = std::min(text.find(','), text.size());
  const auto s = share(text.substr(0, comma));
  const auto t = share(text.substr(std::min(comma + 1, text.size())));
  if (!s || !t)
    throw CLI::ValidationError("--bias",
                               fmt::format("{} is neither none nor two numbers from 0 to 1, S,T", shown(text)));
  options.bias = {*s, *t};
}

}  // namespace

void add_traverse_options(CLI::App& command, hlod::TraverseOptions& options) {
  add_number(command, "--tolerance", options.tolerance_px, RealRange{},
             "Refine nodes whose error is larger on the screen, in pixels; 0: draw the input itself")
      ->capture_default_str();
  command
      .add_option_function<std::string>(
          "--bias", [&options](const std::string& text) { set_bias(options, text); },
          "sw-b, simp, coh, ideal, batch, auto: how much of a node's error counts where only a share of it is "
          "visible. S: from that share itself (0) to a sigmoid (1); T: where the sigmoid turns; none: all of it")
      ->option_text(fmt::format("S,T|none [{},{}]", options.bias.s, options.bias.t));
  add_choice(command, "--metric", options.metric,
             {{"box", hlod::Metric::box}, {"sphere", hlod::Metric::sphere}, {"guaranteed", hlod::Metric::guaranteed}},
             "Which error counts, and where a node is nearest to the eye: box: its error, of its box; sphere: the "
             "same, of its "
             "sphere, as published, which is coarser; guaranteed: a bound of how far its surface is off");
  add_choice(command, "--alpha", options.alpha, {{"exact", hlod::Alpha::exact}, {"paper", hlod::Alpha::paper}},
             "The pixels of a node's box on an empty screen: exact: of its outline; paper: of a cube of its volume");
  add_choice(command, "--coherence", options.coherence,
             {{"mended", hlod::Coherence::mended}, {"published", hlod::Coherence::published}},
             "coh: when nodes are asked about: mended: when all that is known to be visible has been drawn; published: "
             "in turn, while there may be holes where something is still to be drawn");
  add_choice(command, "--cover-model", options.cover_model,
             {{"printed", hlod::CoverModel::printed}, {"corrected", hlod::CoverModel::corrected}},
             "nohc, batch: how probable it is that a box is covered by what is drawn: printed: as the paper has it; "
             "corrected: for boxes inside the image, and with the real number of levels");
  CLI::Option* const geomorph =
      command.add_flag("--geomorph", options.geomorph, "Let vertices slide to where the parent has them");
  command
      .add_flag("--within", options.within,
                "Of HLODs with splits (hlod build --within splits): refine nodes within instead of by their children "
                "where that is enough")
      ->excludes(geomorph);
}

Json to_json(const hlod::TraverseOptions& options) {
  return {{"tolerance_px", options.tolerance_px},
          {"bias", options.biased ? Json{{"s", options.bias.s}, {"t", options.bias.t}} : Json()},
          {"metric", std::array{"box", "sphere", "guaranteed"}.at(static_cast<std::size_t>(options.metric))},
          {"alpha", options.alpha == hlod::Alpha::exact ? "exact" : "paper"},
          {"coherence", options.coherence == hlod::Coherence::mended ? "mended" : "published"},
          {"cover_model", options.cover_model == hlod::CoverModel::corrected ? "corrected" : "printed"},
          {"geomorph", options.geomorph},
          {"within", options.within}};
}

}  // namespace occlod::tool
