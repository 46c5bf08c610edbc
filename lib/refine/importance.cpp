#include "refine/importance.h"

#include <algorithm>
#include <cmath>

#include "refine/tuning.h"

namespace occlod {
namespace {

constexpr float max_steps = 254.0F;

// Returns base^exponent. Exponents that are 1, a half or three eighths give the same bits with every C library.
float power(float base, double exponent) {
  if (exponent == 1.0) return base;
  if (exponent == 0.5) return std::sqrt(base);
  if (exponent == 0.375) {
    const float fourth_root = std::sqrt(std::sqrt(base));
    return fourth_root * std::sqrt(fourth_root);
  }
  if (exponent == 0.0) return 1.0F;
  return std::pow(base, static_cast<float>(exponent));
}

}  // namespace

Importance::Importance(const RefineObject& object)
    : hierarchy_(object.hierarchy),
      attributes_(object.attributes),
      two_sided_(object.two_sided),
      shares_(zeroed_array<std::uint8_t>(object.hierarchy->split_count())) {}

void Importance::begin(const ObjectView& view, const RefineOptions& options) {
  view_ = &view;
  options_ = &options;
  for (const SplitId s : known_) shares_[s] = 0;
  known_.clear();
}

void Importance::find(std::span<const SplitId> splits, std::span<Value> values) {
  stars_.resize(splits.size());
  star_.evaluate(*hierarchy_, splits, *view_, two_sided_, stars_);
  for (std::size_t i = 0; i < splits.size(); ++i) {
    remember(splits[i], stars_[i].visible_share);
    values[i] = of(stars_[i], errors_of(*hierarchy_, splits[i], attributes_));
  }
}

// A surface that is off by e along its normal is off by e / cos along the eye's ray.
Importance::Value Importance::of(const StarView& star, const SplitErrors& errors) const {
  Value value;
  value.visible_share = star.visible_share;
  value.error = ScreenError(errors, star.scale_px);
  if (star.visible_share == 0.0F) return value;  // also where the eye is inside the star and the error has no limit
  value.priority = value.error.quadric_px * power(star.visible_share, tuning_of(*options_).visible_exponent) /
                   power(std::max(star.cosine, min_cosine), tuning_of(*options_).grazing_exponent);
  return value;
}

float Importance::forced_weight(std::span<const SplitId> closure) {
  float unseen = 0.0F;
  find_shares(closure.subspan(1));
  for (const SplitId s : closure.subspan(1)) unseen += 1.0F - visible_share(s);
  return 1.0F / power(1.0F + unseen, tuning_of(*options_).forced_exponent);
}

float Importance::visible_share(SplitId s) {
  if (shares_[s] == 0) remember(s, star_.evaluate(*hierarchy_, s, *view_, two_sided_).visible_share);
  return static_cast<float>(shares_[s] - 1) / max_steps;
}

void Importance::find_shares(std::span<const SplitId> splits) {
  unknown_.clear();
  for (const SplitId s : splits) {
    if (shares_[s] != 0) continue;
    remember(s, 0.0F);  // so that it is listed once
    unknown_.push_back(s);
  }
  if (unknown_.empty()) return;
  stars_.resize(unknown_.size());
  star_.evaluate(*hierarchy_, unknown_, *view_, two_sided_, stars_);
  for (std::size_t i = 0; i < unknown_.size(); ++i) remember(unknown_[i], stars_[i].visible_share);
}

void Importance::set_hidden(SplitId s, bool hidden) {
  if (hidden)
    remember(s, 0.0F);
  else
    shares_[s] = 0;
}

void Importance::remember(SplitId s, float share) {
  if (shares_[s] == 0) known_.push_back(s);
  shares_[s] = static_cast<std::uint8_t>(1.0F + std::round(share * max_steps));
}

}  // namespace occlod
