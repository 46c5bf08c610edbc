#include "raster/projection.h"

#include <cassert>

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/projection.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace occlod::raster::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::ScalableTag<double>;
using Vec = hn::Vec<Doubles>;
constexpr hn::Rebind<std::int32_t, Doubles> ints;
constexpr hn::Rebind<float, Doubles> floats;

// Returns row `row` of the matrix times (x, y, z, 1), summed from the left.
HWY_INLINE Vec transform(const glm::dmat4& m, int row, Vec x, Vec y, Vec z) {
  const Doubles d;
  const Vec xy = hn::Add(hn::Mul(hn::Set(d, m[0][row]), x), hn::Mul(hn::Set(d, m[1][row]), y));
  return hn::Add(hn::Add(xy, hn::Mul(hn::Set(d, m[2][row]), z)), hn::Set(d, m[3][row]));
}

// Rounds to the nearest integer, halves up, as round_subpixel() does.
HWY_INLINE hn::Vec<decltype(ints)> round_to_subpixel(Vec value) {
  const Doubles d;
  return hn::Sub(hn::DemoteTo(ints, hn::Add(value, hn::Set(d, rounding_bias + 0.5))),
                 hn::Set(ints, static_cast<std::int32_t>(rounding_bias)));
}

// Projects the corners from i on, one per lane.
HWY_INLINE void project_lanes(const Projection& projection, std::size_t k, std::size_t i, TriangleBatch& batch) {
  const Doubles d;
  const Vec px = hn::PromoteTo(d, hn::LoadU(floats, batch.object_x[k].data() + i));
  const Vec py = hn::PromoteTo(d, hn::LoadU(floats, batch.object_y[k].data() + i));
  const Vec pz = hn::PromoteTo(d, hn::LoadU(floats, batch.object_z[k].data() + i));
  const Vec x = transform(projection.to_clip(), 0, px, py, pz);
  const Vec y = transform(projection.to_clip(), 1, px, py, pz);
  const Vec z = transform(projection.to_clip(), 2, px, py, pz);
  const Vec w = transform(projection.to_clip(), 3, px, py, pz);
  hn::StoreU(x, d, batch.clip_x[k].data() + i);
  hn::StoreU(y, d, batch.clip_y[k].data() + i);
  hn::StoreU(z, d, batch.clip_z[k].data() + i);
  hn::StoreU(w, d, batch.clip_w[k].data() + i);

  // These comparisons are false for NaN. An infinite x, y or w fails one of them; an infinite z with a finite w cannot
  // come from finite positions.
  const Vec guard_x = hn::Mul(hn::Set(d, projection.guard().x), w);
  const Vec guard_y = hn::Mul(hn::Set(d, projection.guard().y), w);
  const auto before = hn::And(hn::And(hn::Gt(w, hn::Zero(d)), hn::Lt(w, hn::Set(d, 1e300))), hn::Ge(z, hn::Neg(w)));
  const auto inside = hn::And(before, hn::And(hn::Le(hn::Abs(x), guard_x), hn::Le(hn::Abs(y), guard_y)));
  const Vec inverse_w = hn::Div(hn::Set(d, 1.0), w);
  const Vec half_x = hn::Set(d, projection.half_size().x);
  const Vec half_y = hn::Set(d, projection.half_size().y);
  const Vec screen_x = hn::Add(half_x, hn::Mul(hn::Mul(x, inverse_w), half_x));
  const Vec screen_y = hn::Sub(half_y, hn::Mul(hn::Mul(y, inverse_w), half_y));
  const Vec nearness = projection.is_orthographic() ? hn::Mul(hn::Sub(w, z), hn::Set(d, 0.5)) : inverse_w;
  hn::StoreU(nearness, d, batch.nearness[k].data() + i);
  hn::StoreU(hn::DemoteTo(ints, hn::IfThenElseZero(inside, hn::Set(d, 1.0))), ints, batch.drawable[k].data() + i);
  hn::StoreU(round_to_subpixel(hn::IfThenElseZero(inside, screen_x)), ints, batch.x[k].data() + i);
  hn::StoreU(round_to_subpixel(hn::IfThenElseZero(inside, screen_y)), ints, batch.y[k].data() + i);
}

void project_batch(const Projection& projection, TriangleBatch& batch) {
  for (std::size_t corner = 0; corner < 3; ++corner)
    for (std::size_t i = 0; i < batch.size; i += hn::Lanes(Doubles())) project_lanes(projection, corner, i, batch);
}

}  // namespace
}  // namespace occlod::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod::raster {
namespace {

HWY_EXPORT(project_batch);

// Rounds to the nearest integer, halves up. The bias makes the operand positive, where truncation is floor and has a
// SIMD instruction. Precondition: |value| <= 2^24.
std::int32_t round_subpixel(double value) {
  return static_cast<std::int32_t>(value + (rounding_bias + 0.5)) - static_cast<std::int32_t>(rounding_bias);
}

bool is_affine(const glm::mat4& m) { return m[0].w == 0.0F && m[1].w == 0.0F && m[2].w == 0.0F && m[3].w == 1.0F; }

}  // namespace

Projection::Projection(const glm::mat4& object_to_clip, int width, int height)
    : to_clip_(object_to_clip),
      half_size_(glm::dvec2(width, height) * (subpixels / 2.0)),
      guard_(guard_band_px * subpixels / half_size_),
      orthographic_(is_affine(object_to_clip)) {}

void Projection::project(std::span<const glm::vec3> positions, std::span<const Triangle> triangles,
                         TriangleBatch& batch) const {
  assert(!triangles.empty() && triangles.size() <= batch_triangles);
  batch.size = triangles.size();
  for (std::size_t corner = 0; corner < 3; ++corner) {
    for (std::size_t i = 0; i < batch_triangles; ++i) {
      // Lanes beyond the last triangle repeat one point three times, which covers nothing.
      const glm::vec3& p =
          i < triangles.size() ? positions[triangles[i][static_cast<int>(corner)]] : positions[triangles[0][0]];
      batch.object_x[corner][i] = p.x;
      batch.object_y[corner][i] = p.y;
      batch.object_z[corner][i] = p.z;
    }
  }
  HWY_DYNAMIC_DISPATCH(project_batch)(*this, batch);
}

ScreenVertex Projection::snap(const glm::dvec4& clip) const noexcept {
  const double inverse_w = 1.0 / clip.w;
  return {round_subpixel(half_size_.x + clip.x * inverse_w * half_size_.x),
          round_subpixel(half_size_.y - clip.y * inverse_w * half_size_.y),
          orthographic_ ? (clip.w - clip.z) * 0.5 : inverse_w};
}

}  // namespace occlod::raster
#endif  // HWY_ONCE
