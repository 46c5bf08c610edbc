// A device whose answers are chance.
#pragma once

#include <cstdint>
#include <random>
#include <string_view>
#include <vector>

#include "occlod/device.h"
#include "traverse/small_scenes.h"

namespace occlod::hlod::test {

// Answers by chance, and late by chance; the same for the same seed.
class RandomDevice : public RenderDevice {
 public:
  RandomDevice(std::uint64_t seed, double hidden) : random_(seed), hidden_(hidden) {}
  [[nodiscard]] std::string_view name() const noexcept override { return "random"; }
  void begin_frame(const View& view, std::span<const PlacedHlod>) override {
    pixels_ = view.width() * view.height();
    counts_.clear();
  }
  void draw(const NodeDraw&) override {}
  [[nodiscard]] QueryId ask(std::span<const BoxRef>) override {
    const double share = uniform(random_, 0, 1);
    const bool hidden = uniform(random_, 0, 1) < hidden_;
    counts_.push_back(hidden ? 0U : 1U + static_cast<std::uint32_t>(share * share * share * pixels_ / 10));
    return static_cast<QueryId>(counts_.size() - 1);
  }
  [[nodiscard]] QueryId ask_each(std::span<const BoxRef> boxes) override { return ask(boxes); }
  [[nodiscard]] bool available(QueryId) override { return random_() % 4 == 0; }
  [[nodiscard]] std::span<const std::uint32_t> wait(QueryId query) override { return {&counts_[query], 1}; }
  void visit(std::size_t) override {}
  FrameTimes end_frame() override { return {}; }

 private:
  std::mt19937_64 random_;
  double hidden_;
  double pixels_ = 0.0;
  std::vector<std::uint32_t> counts_;
};

}  // namespace occlod::hlod::test
