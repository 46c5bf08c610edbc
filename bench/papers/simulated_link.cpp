#include "papers/simulated_link.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include "base/option_checker.h"

namespace occlod::hlod {
namespace {

constexpr double frames_per_second = 60.0;

}  // namespace

CacheOptions TrialCacheOptions::cache() const {
  return {budget_bytes, load == TrialLoad::blocking ? LoadMode::blocking : LoadMode::async};
}

void simulate_link(NodeStore& store, const TrialCacheOptions& options) {
  const OptionChecker checker("simulated link");
  checker.positive("simulated_mb_per_s", options.simulated_mb_per_s);
  checker.at_least("frame_bytes", static_cast<double>(options.frame_bytes), 1.0);
  checker.in_range("simulated_delay", options.simulated_delay, 0, 1000);
  if (options.load == TrialLoad::simulated) store.set_link(std::make_unique<SimulatedLink>(options));
}

SimulatedLink::SimulatedLink(const TrialCacheOptions& options)
    : MeshLink(options.frame_bytes),
      bytes_in_frame_(options.simulated_mb_per_s * 1e6 / frames_per_second),
      delay_(static_cast<std::size_t>(options.simulated_delay)) {}

void SimulatedLink::push(std::vector<MeshLoad> loads) { std::ranges::move(loads, std::back_inserter(line_)); }

std::vector<MeshLoad> SimulatedLink::withdraw() {
  const auto first = line_.begin() + (transferred_ > 0.0 ? 1 : 0);  // then there is one at the front
  std::vector<MeshLoad> loads;
  std::move(first, line_.end(), std::back_inserter(loads));
  line_.erase(first, line_.end());
  return loads;
}

std::vector<MeshLoad> SimulatedLink::pass_frame() {
  std::vector<MeshLoad> loads;
  for (std::size_t& frames : coming_) --frames;
  if (!line_.empty()) transferred_ += bytes_in_frame_;
  while (!line_.empty() && transferred_ >= static_cast<double>(line_.front().bytes)) {
    transferred_ -= static_cast<double>(line_.front().bytes);
    loads.push_back(std::move(line_.front()));
    line_.pop_front();
    coming_.push_back(delay_);
  }
  if (line_.empty()) transferred_ = 0.0;  // what an idle link could have transferred is lost
  return loads;
}

std::size_t SimulatedLink::take_due() {
  std::size_t due = 0;
  for (; !coming_.empty() && coming_.front() == 0; ++due) coming_.pop_front();
  return due;
}

std::vector<MeshLoad> SimulatedLink::clear() {
  coming_.clear();
  transferred_ = 0.0;
  return withdraw();
}

}  // namespace occlod::hlod
