#include "papers/trial_command.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "hlod_device.h"
#include "hlod_options.h"
#include "option_values.h"
#include "papers/trial_devices.h"

namespace occlod::tool {
namespace {

constexpr std::string_view virtual_prefix = "virtual:", simulated_prefix = "simulated:";
constexpr double min_speed = 1e-6, max_speed = 1e6;  // MB a second

std::optional<double> share(const std::string& text) {
  double value = 0.0;
  if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value) || value < 0.0 || value > 1.0) return {};
  return value;
}

// "S,T", or "none".
void set_bias(hlod::TrialOptions& options, const std::string& text) {
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

void set_load(hlod::TrialCacheOptions& options, const std::string& text) {
  if (text == "blocking" || text == "async") {
    options.load = text == "async" ? hlod::TrialLoad::async : hlod::TrialLoad::blocking;
    return;
  }
  double speed = 0.0;
  if (!text.starts_with(simulated_prefix) || !CLI::detail::lexical_cast(text.substr(simulated_prefix.size()), speed) ||
      !(speed >= min_speed && speed <= max_speed))
    throw CLI::ValidationError("--load",
                               fmt::format("{} is not blocking, async or simulated:MBPS, megabytes a second from {} to "
                                           "{}",
                                           shown(text), min_speed, max_speed));
  options.load = hlod::TrialLoad::simulated;
  options.simulated_mb_per_s = speed;
}

}  // namespace

const std::vector<std::pair<std::string, hlod::TrialStrategy>>& trial_strategies() {
  using hlod::TrialStrategy;
  static const std::vector<std::pair<std::string, TrialStrategy>> all = {
      {"vfc", TrialStrategy::vfc},           {"sw", TrialStrategy::sw},         {"sw-b", TrialStrategy::sw_b},
      {"bool", TrialStrategy::boolean},      {"simp", TrialStrategy::simp},     {"coh", TrialStrategy::coh},
      {"ideal", TrialStrategy::ideal},       {"nohc", TrialStrategy::nohc},     {"chc++", TrialStrategy::chc_plus},
      {"two-pass", TrialStrategy::two_pass}, {"cesium", TrialStrategy::cesium}, {"optimum", TrialStrategy::optimum},
      {"batch", TrialStrategy::batch},       {"auto", TrialStrategy::automatic}};
  return all;
}

const std::string& name_of(hlod::TrialStrategy strategy) {
  return std::ranges::find(trial_strategies(), strategy, [](const auto& named) { return named.second; })->first;
}

void add_trial_options(CLI::App& command, hlod::TrialOptions& options) {
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
             "coh: when nodes are asked about: mended: when all that is known to be visible has been drawn, and again "
             "where something nearer was drawn later; published: in turn, while there may be holes where something is "
             "still to be drawn");
  add_choice(command, "--cover-model", options.cover_model,
             {{"in-scene", hlod::CoverModel::in_scene}, {"printed", hlod::CoverModel::printed}},
             "nohc, batch: how probable it is that a box is covered by what is drawn: in-scene: where boxes lie at "
             "random in the part of the image that the scene covers; printed: in all of it, as in the paper, with the "
             "levels of a binary tree");
  add_within(command, options.geomorph, options.within,
             "splits, of HLODs that have them: refine nodes within where that is enough");
}

Json to_json(const hlod::TrialOptions& options) {
  return {{"tolerance_px", options.tolerance_px},
          {"bias", options.biased ? Json{{"s", options.bias.s}, {"t", options.bias.t}} : Json()},
          {"metric", std::array{"box", "sphere", "guaranteed"}.at(static_cast<std::size_t>(options.metric))},
          {"alpha", options.alpha == hlod::Alpha::exact ? "exact" : "paper"},
          {"coherence", options.coherence == hlod::Coherence::mended ? "mended" : "published"},
          {"cover_model", options.cover_model == hlod::CoverModel::printed ? "printed" : "in-scene"},
          {"geomorph", options.geomorph},
          {"within", options.within}};
}

void add_trial_cache_options(CLI::App& command, std::optional<hlod::TrialCacheOptions>& options) {
  const auto chosen = std::make_shared<hlod::TrialCacheOptions>();
  CLI::Option* const cache = command.add_option_function<std::string>(
      "--memory",
      [&options, chosen](const std::string& text) {
        const auto bytes = byte_count(text);
        if (!bytes || *bytes == 0)
          throw CLI::ValidationError(
              "--memory", fmt::format("{} is not a number of bytes above 0, or one with K, M or G", shown(text)));
        chosen->budget_bytes = *bytes;
        options = *chosen;
      },
      "Of .ohlod files: read meshes when they are needed, and keep no more than so many bytes of them in memory");
  cache->option_text("BYTES");
  command
      .add_option_function<std::string>(
          "--load",
          [&options, chosen](const std::string& text) {
            set_load(*chosen, text);
            if (options) *options = *chosen;
          },
          "How meshes are read: async, blocking, or simulated: as async, but by a disk of so many megabytes a second "
          "at 60 frames a second, the same in every run")
      ->option_text("async|blocking|simulated:MBPS [async]")
      ->needs(cache);
}

Json to_json(const hlod::TrialCacheOptions& options) {
  const std::string load = options.load == hlod::TrialLoad::simulated
                               ? fmt::format("{}{}", simulated_prefix, options.simulated_mb_per_s)
                           : options.load == hlod::TrialLoad::async ? "async"
                                                                    : "blocking";
  return {{"budget_bytes", options.budget_bytes}, {"load", load}};
}

TrialDevice make_trial_device(const std::string& name, const std::shared_ptr<hlod::NodeImages>& images) {
  if (!name.starts_with(virtual_prefix)) return {name, make_hlod_device(name).device, std::nullopt};
  hlod::DeviceCosts costs = hlod::device_preset(name.substr(virtual_prefix.size()));
  auto device = std::make_unique<hlod::VirtualDevice>(costs, images);
  costs.name = name;
  return {name, std::move(device), std::move(costs)};
}

TrialDevice replaying_device(const std::string& file) {
  auto device = std::make_unique<hlod::ReplayingDevice>(hlod::read_recording(file));
  const std::string name(device->name());
  return {name, std::move(device), std::nullopt};
}

}  // namespace occlod::tool
