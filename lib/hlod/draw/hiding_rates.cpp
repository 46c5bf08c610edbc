#include "hlod/draw/hiding_rates.h"

#include <algorithm>

namespace occlod::hlod {
namespace {

constexpr double kept = 0.98;          // of the counts, from frame to frame
constexpr double prior_frames = 16.0;  // that the first guess counts for
constexpr double prior_nodes = 2.0;    // likewise
constexpr double least_rate = 0.002;   // a guess too: nothing stays visible for ever

}  // namespace

std::size_t HidingRates::class_of(double cover_probability) {
  const double place = cover_probability * static_cast<double>(classes);
  return std::min(static_cast<std::size_t>(std::max(place, 0.0)), classes - 1);
}

void HidingRates::begin_frame() {
  for (auto* counts : {&visible_, &new_})
    for (Count& count : *counts) count = {kept * count.hidden, kept * count.all};
}

void HidingRates::note_visible(double cover_probability, double frames, bool hidden) {
  Count& count = visible_[class_of(cover_probability)];
  count.all += std::max(frames, 1.0);
  count.hidden += hidden ? 1.0 : 0.0;
}

void HidingRates::note_new(double cover_probability, bool hidden) {
  Count& count = new_[class_of(cover_probability)];
  count.all += 1.0;
  count.hidden += hidden ? 1.0 : 0.0;
}

double HidingRates::of_visible(double cover_probability) const {
  const Count& count = visible_[class_of(cover_probability)];
  const double guess = std::max(0.5 * cover_probability * cover_probability, least_rate);
  return (count.hidden + prior_frames * guess) / (count.all + prior_frames);
}

double HidingRates::of_new(double cover_probability) const {
  const Count& count = new_[class_of(cover_probability)];
  return (count.hidden + prior_nodes * cover_probability) / (count.all + prior_nodes);
}

}  // namespace occlod::hlod
