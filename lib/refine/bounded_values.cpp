#include <algorithm>
#include <array>
#include <bit>

#include "refine/front.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "refine/bounded_values.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

template <class D>
HWY_INLINE hn::Mask<D> has_flags(D d, const std::uint16_t* flags, std::uint32_t all, std::uint32_t none) {
  const hn::RebindToUnsigned<D> ints;
  const auto found = hn::PromoteTo(ints, hn::LoadU(hn::Rebind<std::uint16_t, D>(), flags));
  return hn::RebindMask(d, hn::Eq(hn::And(found, hn::Set(ints, all | none)), hn::Set(ints, all)));
}

// Returns how far what each value depends on has moved relative to the camera since it was computed, object units.
template <class D>
HWY_INLINE hn::Vec<D> moved(D d, const BoundedValues& of, const ViewMotion& now, std::size_t k) {
  const auto radius = hn::LoadU(d, &of.radius[k]);
  const auto base = hn::IfThenElse(hn::Lt(radius, hn::Zero(d)), hn::Set(d, static_cast<float>(now.center_distance)),
                                   hn::Set(d, static_cast<float>(now.eye_distance)));
  const auto at = hn::Add(base, hn::Mul(hn::Set(d, static_cast<float>(now.rotation_rad)), hn::Abs(radius)));
  return hn::Sub(hn::Mul(hn::Set(d, 1.0F + motion_rounding), at), hn::LoadU(d, &of.motion_then[k]));
}

// Returns how far the eye has moved since each value was computed, object units.
template <class D>
HWY_INLINE hn::Vec<D> went(D d, const BoundedValues& of, const ViewMotion& now, std::size_t k) {
  return hn::Sub(hn::Set(d, (1.0F + motion_rounding) * static_cast<float>(now.eye_distance)),
                 hn::LoadU(d, &of.eye_distance_then[k]));
}

template <class D>
HWY_INLINE hn::Vec<D> error_factor_of(D d, const BoundedValues& of, const ViewMotion& now, std::size_t k) {
  const auto one = hn::Set(d, 1.0F), by_eye = moved(d, of, now, k), by_way = went(d, of, now, k);
  const auto holds = hn::And(hn::Le(by_eye, hn::LoadU(d, &of.motion_limit[k])),
                             hn::Le(by_way, hn::LoadU(d, &of.eye_distance_limit[k])));
  const auto factor = hn::Mul(hn::Add(one, hn::Mul(hn::LoadU(d, &of.per_motion[k]), by_eye)),
                              hn::Add(one, hn::Mul(hn::LoadU(d, &of.per_eye_distance[k]), by_way)));
  return hn::IfThenElse(holds, factor, hn::Set(d, std::numeric_limits<float>::quiet_NaN()));
}

// Holds the arrays of BoundedProducts. They are read once, because for all the compiler knows, appending to a result
// might change them.
struct ProductArrays {
  explicit ProductArrays(const BoundedProducts& of)
      : size(of.flags.size()),
        value(of.values.value.data()),
        error_factor(of.values.error_factor.data()),
        weight(of.weights.empty() ? nullptr : of.weights.data()),
        flags(of.flags.data()) {}

  std::size_t size;
  const float* value;
  const float* error_factor;
  const float* weight;
  const std::uint16_t* flags;
};

template <class D>
HWY_INLINE hn::Vec<D> product(D d, const ProductArrays& of, std::size_t k) {
  const auto value = hn::LoadU(d, of.value + k);
  if (of.weight == nullptr) return value;
  const auto weight = hn::LoadU(d, of.weight + k);
  return hn::IfThenElseZero(hn::Gt(weight, hn::Zero(d)), hn::Mul(value, weight));  // avoids 0 times an infinite scale
}

// Returns which nodes are selected. The comparisons are written so that NaN, an expired value, is selected.
template <class D>
HWY_INLINE hn::Mask<D> is_selected(D d, const ProductArrays& of, const Selection& selection, std::size_t k) {
  const auto flagged = has_flags(d, of.flags + k, selection.all, selection.none);
  if (hn::AllFalse(d, flagged)) return flagged;
  const auto at = product(d, of, k), error_factor = hn::LoadU(d, of.error_factor + k);
  auto mask = hn::AndNot(hn::Le(hn::Mul(at, error_factor), hn::Set(d, selection.may_exceed)), flagged);
  if (selection.may_be_below < std::numeric_limits<float>::infinity())
    mask = hn::AndNot(hn::Ge(at, hn::Mul(hn::Set(d, selection.may_be_below), error_factor)), mask);
  return mask;
}

template <class D>
HWY_INLINE void append(D d, hn::Mask<D> mask, std::size_t first, std::vector<std::uint32_t>& out) {
  std::array<std::uint8_t, 8> bytes{};  // enough for any number of lanes
  hn::StoreMaskBits(d, mask, bytes.data());
  for (std::uint64_t bits = std::bit_cast<std::uint64_t>(bytes); bits != 0; bits &= bits - 1)
    out.push_back(static_cast<std::uint32_t>(first) + static_cast<std::uint32_t>(std::countr_zero(bits)));
}

// Calls visit(tag, first) for whole vectors, then for single nodes.
template <typename Visit>
HWY_INLINE void for_each_vector(std::size_t size, const Visit& visit) {
  const hn::ScalableTag<float> whole;
  const hn::CappedTag<float, 1> single;
  std::size_t k = 0;
  for (; k + hn::Lanes(whole) <= size; k += hn::Lanes(whole)) visit(whole, k);
  for (; k < size; ++k) visit(single, k);
}

void select_nodes(const BoundedProducts& products, const Selection& wanted, std::vector<std::uint32_t>& out) {
  const ProductArrays of(products);
  const Selection selection = wanted;
  for_each_vector(of.size, [&, of, selection](auto d, std::size_t k) HWY_ATTR {
    const auto mask = is_selected(d, of, selection, k);
    if (!hn::AllFalse(d, mask)) append(d, mask, k, out);
  });
}

std::size_t count_nodes(const BoundedProducts& products, const Selection& selection) {
  const ProductArrays of(products);
  std::size_t found = 0;
  for_each_vector(of.size, [&, of](auto d, std::size_t k)
                               HWY_ATTR { found += hn::CountTrue(d, is_selected(d, of, selection, k)); });
  return found;
}

void update_error_factors(BoundedValues& values, const ViewMotion& now) {
  for_each_vector(values.value.size(), [&](auto d, std::size_t k) HWY_ATTR {
    hn::StoreU(error_factor_of(d, values, now, k), d, &values.error_factor[k]);
  });
}

float find_largest_at_least(const BoundedProducts& products, std::uint16_t all, std::uint16_t none) {
  const ProductArrays of(products);
  float largest = 0.0F;
  const hn::ScalableTag<float> whole;
  auto found = hn::Zero(whole);
  std::size_t k = 0;
  const auto least = [&](auto d) HWY_ATTR {
    const auto error_factor = hn::LoadU(d, of.error_factor + k);
    const auto known = hn::And(has_flags(d, of.flags + k, all, none), hn::Eq(error_factor, error_factor));
    return hn::IfThenElseZero(known, hn::Div(product(d, of, k), error_factor));
  };
  for (; k + hn::Lanes(whole) <= of.size; k += hn::Lanes(whole)) found = hn::Max(found, least(whole));
  largest = hn::GetLane(hn::MaxOfLanes(whole, found));
  for (; k < of.size; ++k) largest = std::max(largest, hn::GetLane(least(hn::CappedTag<float, 1>())));
  return largest;
}

}  // namespace
}  // namespace occlod::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod {
namespace {

HWY_EXPORT(select_nodes);
HWY_EXPORT(count_nodes);
HWY_EXPORT(update_error_factors);
HWY_EXPORT(find_largest_at_least);

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();
// No motion is this small, not even that to a sum that has begun again at 0.
constexpr float no_motion = -std::numeric_limits<float>::infinity();

template <typename Visit>
void for_each_array(BoundedValues& of, const Visit& visit) {
  for (std::vector<float>* array :
       {&of.value, &of.error_factor, &of.radius, &of.motion_then, &of.per_motion, &of.motion_limit,
        &of.eye_distance_then, &of.per_eye_distance, &of.eye_distance_limit})
    visit(*array);
}

}  // namespace

void BoundedValues::add() {
  for_each_array(*this, [](std::vector<float>& array) { array.push_back(0.0F); });
  forget(value.size() - 1);
}

void BoundedValues::remove(std::size_t k) {
  for_each_array(*this, [&](std::vector<float>& array) {
    array[k] = array.back();
    array.pop_back();
  });
}

void BoundedValues::clear() {
  for_each_array(*this, [](std::vector<float>& array) { array.clear(); });
}

void BoundedValues::put(std::size_t k, float computed, const ErrorGrowth& growth, const ViewMotion& now) {
  value[k] = computed;
  error_factor[k] = 1.0F;
  radius[k] = growth.radius;
  motion_then[k] = now.displacement(growth.radius);
  per_motion[k] = growth.per_motion;
  motion_limit[k] = growth.motion_limit;
  eye_distance_then[k] = static_cast<float>(now.eye_distance);
  per_eye_distance[k] = growth.per_eye_distance;
  eye_distance_limit[k] = growth.eye_distance_limit;
}

void BoundedValues::forget(std::size_t k) {
  error_factor[k] = unknown;
  motion_limit[k] = no_motion;
}

void BoundedValues::forget_all() {
  std::fill(error_factor.begin(), error_factor.end(), unknown);
  std::fill(motion_limit.begin(), motion_limit.end(), no_motion);
}

void BoundedValues::update(const ViewMotion& now) { HWY_DYNAMIC_DISPATCH(update_error_factors)(*this, now); }

void select(const BoundedProducts& products, const Selection& selection, std::vector<std::uint32_t>& out) {
  HWY_DYNAMIC_DISPATCH(select_nodes)(products, selection, out);
}
std::size_t count(const BoundedProducts& products, const Selection& selection) {
  return HWY_DYNAMIC_DISPATCH(count_nodes)(products, selection);
}
float largest_at_least(const BoundedProducts& products, std::uint16_t all, std::uint16_t none) {
  return HWY_DYNAMIC_DISPATCH(find_largest_at_least)(products, all, none);
}

}  // namespace occlod
#endif  // HWY_ONCE
