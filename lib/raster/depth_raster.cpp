#include "raster/projection.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/depth_raster.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#ifndef OCCLOD_RASTER_DEPTH_RASTER_ONCE
#define OCCLOD_RASTER_DEPTH_RASTER_ONCE
namespace occlod::raster {

// Small triangles, at most depth_reach pixels a side, are drawn by edge functions, larger ones by rows. A pixel of a
// block is then less than 2^14 + 2 * 16 * 2^8 subpixels away from any corner, and edge functions stay below 2^30.
static_assert(depth_reach <= 64);

// Width of the widest block of pixels.
inline constexpr int widest_block = 16;

template <class T>
using PerTriangle = std::array<T, batch_triangles>;

// A pixel centre is inside where start + step_column * columns + step_row * rows >= 0; columns and rows are counted
// from the first pixel of the triangle's bounding box.
struct EdgeFunctions {
  PerTriangle<std::int32_t> start, step_column, step_row;
};

// A batch of triangles after set-up. Bounding boxes [first, end) are inside the image.
struct SetupBatch {
  PerTriangle<std::int32_t> first_column, end_column, first_row, end_row;
  PerTriangle<std::int32_t> kind;                 // a TriangleKind
  std::array<EdgeFunctions, 3> edges;             // of small triangles
  PerTriangle<float> depth, per_column, per_row;  // depth is at the first pixel of the bounding box
  PerTriangle<float> smallest, largest;
};

enum TriangleKind : std::int32_t { nothing = 0, small_triangle = 1, large_triangle = 2 };

}  // namespace occlod::raster
#endif  // OCCLOD_RASTER_DEPTH_RASTER_ONCE

HWY_BEFORE_NAMESPACE();
namespace occlod::raster::HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR

// Vectors would have one lane here, so drawing by rows is faster.
bool draw_batch(const TriangleBatch&, const DepthImage&, PixelRect&) { return false; }
bool draw_batch_counted(const TriangleBatch&, const DepthImage&, DrawnPixels&) { return false; }

#else

namespace hn = hwy::HWY_NAMESPACE;

// Set-up works with one triangle per lane.

using Doubles = hn::ScalableTag<double>;
using Ints = hn::Rebind<std::int32_t, Doubles>;
using Floats = hn::Rebind<float, Doubles>;
using DoubleVec = hn::Vec<Doubles>;
using IntVec = hn::Vec<Ints>;

struct CornerLanes {
  IntVec x, y;
  DoubleVec nearness;
};

HWY_INLINE CornerLanes load_corner(const TriangleBatch& batch, std::size_t k, std::size_t i) {
  return {hn::LoadU(Ints(), batch.x[k].data() + i), hn::LoadU(Ints(), batch.y[k].data() + i),
          hn::LoadU(Doubles(), batch.nearness[k].data() + i)};
}

template <class V>
HWY_INLINE V smallest_of(V a, V b, V c) {
  return hn::Min(hn::Min(a, b), c);
}

template <class V>
HWY_INLINE V largest_of(V a, V b, V c) {
  return hn::Max(hn::Max(a, b), c);
}

// Computes first_pixel() per lane.
HWY_INLINE IntVec first_pixel_lanes(IntVec subpixel) {
  return hn::ShiftRight<subpixel_bits>(hn::Add(subpixel, hn::Set(Ints(), half_pixel - 1)));
}

HWY_INLINE DoubleVec difference(IntVec a, IntVec b) { return hn::PromoteTo(Doubles(), hn::Sub(a, b)); }

// Stores the edge from a to b of a triangle whose inside is where the edge function, with its sign flipped by `flip` (0
// or -1), is positive. Pixel centres on the edge belong to the triangle when it is a top or a left edge.
HWY_INLINE void store_edge(const CornerLanes& a, const CornerLanes& b, IntVec flip, IntVec first_x, IntVec first_y,
                           EdgeFunctions& edge, std::size_t i) {
  const Ints d;
  const IntVec zero = hn::Zero(d);
  const IntVec dx = hn::Sub(hn::Xor(hn::Sub(b.x, a.x), flip), flip);
  const IntVec dy = hn::Sub(hn::Xor(hn::Sub(b.y, a.y), flip), flip);
  const auto top_or_left = hn::Or(hn::Lt(dy, zero), hn::And(hn::Eq(dy, zero), hn::Gt(dx, zero)));
  const IntVec at_first = hn::Sub(hn::Mul(dx, hn::Sub(first_y, a.y)), hn::Mul(dy, hn::Sub(first_x, a.x)));
  hn::StoreU(hn::IfThenElse(top_or_left, at_first, hn::Sub(at_first, hn::Set(d, 1))), d, edge.start.data() + i);
  hn::StoreU(hn::ShiftLeft<subpixel_bits>(hn::Neg(dy)), d, edge.step_column.data() + i);
  hn::StoreU(hn::ShiftLeft<subpixel_bits>(dx), d, edge.step_row.data() + i);
}

struct BoxLanes {
  IntVec first_column, end_column, first_row, end_row;
};

// Uses the same arithmetic as depth_plane() and DepthPlane::at().
HWY_INLINE void store_plane(const CornerLanes& a, const CornerLanes& b, const CornerLanes& c, DoubleVec twice_area,
                            const BoxLanes& box, SetupBatch& setup, std::size_t i) {
  const Doubles d;
  const DoubleVec scale = hn::Div(hn::Set(d, double{subpixels}), twice_area);
  const DoubleVec db = hn::Sub(b.nearness, a.nearness);
  const DoubleVec dc = hn::Sub(c.nearness, a.nearness);
  const DoubleVec per_column =
      hn::Mul(hn::Sub(hn::Mul(db, difference(c.y, a.y)), hn::Mul(dc, difference(b.y, a.y))), scale);
  const DoubleVec per_row =
      hn::Mul(hn::Sub(hn::Mul(dc, difference(b.x, a.x)), hn::Mul(db, difference(c.x, a.x))), scale);
  const DoubleVec half = hn::Set(d, 0.5);
  const DoubleVec pixel = hn::Set(d, 1.0 / subpixels);
  const DoubleVec columns = hn::Sub(half, hn::Mul(hn::PromoteTo(d, a.x), pixel));
  const DoubleVec rows = hn::Sub(half, hn::Mul(hn::PromoteTo(d, a.y), pixel));
  const DoubleVec at_origin = hn::Add(hn::Add(a.nearness, hn::Mul(per_column, columns)), hn::Mul(per_row, rows));
  const DoubleVec at_row = hn::Add(at_origin, hn::Mul(per_row, hn::PromoteTo(d, box.first_row)));
  const DoubleVec at_first = hn::Add(at_row, hn::Mul(per_column, hn::PromoteTo(d, box.first_column)));
  hn::StoreU(hn::DemoteTo(Floats(), per_column), Floats(), setup.per_column.data() + i);
  hn::StoreU(hn::DemoteTo(Floats(), per_row), Floats(), setup.per_row.data() + i);
  hn::StoreU(hn::DemoteTo(Floats(), at_first), Floats(), setup.depth.data() + i);
  hn::StoreU(hn::DemoteTo(Floats(), smallest_of(a.nearness, b.nearness, c.nearness)), Floats(),
             setup.smallest.data() + i);
  hn::StoreU(hn::DemoteTo(Floats(), largest_of(a.nearness, b.nearness, c.nearness)), Floats(),
             setup.largest.data() + i);
}

HWY_INLINE BoxLanes pixel_box(const CornerLanes& a, const CornerLanes& b, const CornerLanes& c,
                              const DepthImage& target) {
  const Ints d;
  const IntVec zero = hn::Zero(d);
  return {hn::Max(first_pixel_lanes(smallest_of(a.x, b.x, c.x)), zero),
          hn::Min(first_pixel_lanes(largest_of(a.x, b.x, c.x)), hn::Set(d, target.width)),
          hn::Max(first_pixel_lanes(smallest_of(a.y, b.y, c.y)), zero),
          hn::Min(first_pixel_lanes(largest_of(a.y, b.y, c.y)), hn::Set(d, target.height))};
}

// Returns the size of the triangle along one axis, inside the image or not.
HWY_INLINE IntVec extent(IntVec a, IntVec b, IntVec c) { return hn::Sub(largest_of(a, b, c), smallest_of(a, b, c)); }

HWY_INLINE void set_up_lanes(const TriangleBatch& batch, std::size_t i, const DepthImage& target, SetupBatch& setup,
                             BoxLanes& around) {
  const Ints d;
  const CornerLanes a = load_corner(batch, 0, i), b = load_corner(batch, 1, i), c = load_corner(batch, 2, i);
  const BoxLanes box = pixel_box(a, b, c, target);
  hn::StoreU(box.first_column, d, setup.first_column.data() + i);
  hn::StoreU(box.end_column, d, setup.end_column.data() + i);
  hn::StoreU(box.first_row, d, setup.first_row.data() + i);
  hn::StoreU(box.end_row, d, setup.end_row.data() + i);

  // This is exact, because the products are below 2^48.
  const DoubleVec twice_area =
      hn::Sub(hn::Mul(difference(b.x, a.x), difference(c.y, a.y)), hn::Mul(difference(c.x, a.x), difference(b.y, a.y)));
  store_plane(a, b, c, twice_area, box, setup, i);
  // The sign is -1, 0 or 1.
  const Doubles dd;
  const IntVec sign = hn::DemoteTo(Ints(), hn::Min(hn::Max(twice_area, hn::Set(dd, -1.0)), hn::Set(dd, 1.0)));
  const IntVec flip = hn::ShiftRight<31>(sign);
  const IntVec first_x = hn::Add(hn::ShiftLeft<subpixel_bits>(box.first_column), hn::Set(d, half_pixel));
  const IntVec first_y = hn::Add(hn::ShiftLeft<subpixel_bits>(box.first_row), hn::Set(d, half_pixel));
  store_edge(a, b, flip, first_x, first_y, setup.edges[0], i);
  store_edge(b, c, flip, first_x, first_y, setup.edges[1], i);
  store_edge(c, a, flip, first_x, first_y, setup.edges[2], i);

  const IntVec drawable =
      hn::And(hn::And(hn::LoadU(d, batch.drawable[0].data() + i), hn::LoadU(d, batch.drawable[1].data() + i)),
              hn::LoadU(d, batch.drawable[2].data() + i));
  const auto covers = hn::And(hn::And(hn::Lt(box.first_column, box.end_column), hn::Lt(box.first_row, box.end_row)),
                              hn::And(hn::Ne(sign, hn::Zero(d)), hn::Ne(drawable, hn::Zero(d))));
  const IntVec size = hn::Max(extent(a.x, b.x, c.x), extent(a.y, b.y, c.y));
  const auto large = hn::Gt(size, hn::Set(d, depth_reach * subpixels));
  const IntVec kind =
      hn::IfThenElse(large, hn::Set(d, std::int32_t{large_triangle}), hn::Set(d, std::int32_t{small_triangle}));
  hn::StoreU(hn::IfThenElseZero(covers, kind), d, setup.kind.data() + i);
  around.first_column = hn::IfThenElse(covers, hn::Min(around.first_column, box.first_column), around.first_column);
  around.end_column = hn::IfThenElse(covers, hn::Max(around.end_column, box.end_column), around.end_column);
  around.first_row = hn::IfThenElse(covers, hn::Min(around.first_row, box.first_row), around.first_row);
  around.end_row = hn::IfThenElse(covers, hn::Max(around.end_row, box.end_row), around.end_row);
}

HWY_INLINE PixelRect reduced(const BoxLanes& box) {
  const Ints d;
  return {hn::GetLane(hn::MinOfLanes(d, box.first_column)), hn::GetLane(hn::MinOfLanes(d, box.first_row)),
          hn::GetLane(hn::MaxOfLanes(d, box.end_column)), hn::GetLane(hn::MaxOfLanes(d, box.end_row))};
}

// Filling works with one pixel per lane.

using Pixels = hn::CappedTag<float, widest_block>;
using PixelInts = hn::RebindToSigned<Pixels>;
using PixelVec = hn::Vec<Pixels>;
using PixelIntVec = hn::Vec<PixelInts>;
constexpr int block = static_cast<int>(hn::MaxLanes(Pixels()));

// Returns first, first + 1, ... as the sum of a constant and a broadcast; hn::Iota of a variable goes through memory.
template <class D>
HWY_INLINE hn::Vec<D> counting_from(D d, hn::TFromD<D> first) {
  return hn::Add(hn::Iota(d, hn::TFromD<D>{0}), hn::Set(d, first));
}

struct EdgeLanes {
  PixelIntVec value, step_row;
};

HWY_INLINE EdgeLanes load_edge(const EdgeFunctions& edge, std::size_t i, PixelIntVec columns) {
  const PixelInts d;
  return {hn::Add(hn::Set(d, edge.start[i]), hn::Mul(hn::Set(d, edge.step_column[i]), columns)),
          hn::Set(d, edge.step_row[i])};
}

HWY_INLINE PixelVec clamp(PixelVec z, PixelVec smallest, PixelVec largest) {
  return hn::Min(hn::Max(z, smallest), largest);
}

// Draws the nearer depth in lanes where the sign bit of `outside` is clear.
HWY_INLINE void draw_block(PixelVec z, PixelIntVec outside, float* depth) {
  const Pixels d;
#if HWY_TARGET == HWY_SSSE3
  outside = hn::BroadcastSignBit(outside);  // Highway 1.0 omits this and would choose bit by bit
#endif
  const PixelVec old = hn::LoadU(d, depth);
#if HWY_TARGET == HWY_EMU128  // HWY_EMU128 compares with zero as floats, and most negative integers are NaN as floats
  const auto is_outside = hn::RebindMask(d, hn::Lt(outside, hn::Zero(PixelInts())));
  hn::StoreU(hn::IfThenElse(is_outside, old, hn::Max(old, z)), d, depth);
#else
  hn::StoreU(hn::IfNegativeThenElse(hn::BitCast(d, outside), old, hn::Max(old, z)), d, depth);
#endif
}

// Counts lanes whose sign bit is clear, except those that an earlier block has counted.
class FragmentCount {
 public:
  // Lanes with negative `fresh` have been counted.
  HWY_INLINE explicit FragmentCount(PixelIntVec fresh) : fresh_(fresh), outside_(hn::Zero(PixelInts())) {}
  HWY_INLINE void add(PixelIntVec outside) {
    outside_ = hn::Add(outside_, hn::ShiftRight<31>(hn::Or(outside, fresh_)));
  }
  [[nodiscard]] HWY_INLINE std::int32_t after(std::int32_t rows) const {
    return rows * block + hn::GetLane(hn::SumOfLanes(PixelInts(), outside_));
  }

 private:
  PixelIntVec fresh_, outside_;
};

// Draws all rows of a small triangle in the block of columns from x on, and counts fragments from column `first` on.
template <bool counts>
HWY_INLINE std::int32_t draw_columns(const SetupBatch& setup, std::size_t i, std::int32_t x, std::int32_t first,
                                     const DepthImage& target) {
  const Pixels d;
  const PixelIntVec columns = counting_from(PixelInts(), x - setup.first_column[i]);
  EdgeLanes e0 = load_edge(setup.edges[0], i, columns);
  EdgeLanes e1 = load_edge(setup.edges[1], i, columns);
  EdgeLanes e2 = load_edge(setup.edges[2], i, columns);
  const PixelVec on_first_row =
      hn::Add(hn::Set(d, setup.depth[i]), hn::Mul(hn::Set(d, setup.per_column[i]), hn::ConvertTo(d, columns)));
  const PixelVec per_row = hn::Set(d, setup.per_row[i]);
  const PixelVec smallest = hn::Set(d, setup.smallest[i]);
  const PixelVec largest = hn::Set(d, setup.largest[i]);
  const std::int32_t first_row = HWY_MAX(setup.first_row[i], target.rows.first);
  const std::int32_t skipped = first_row - setup.first_row[i];
  e0.value = hn::Add(e0.value, hn::Mul(e0.step_row, hn::Set(PixelInts(), skipped)));
  e1.value = hn::Add(e1.value, hn::Mul(e1.step_row, hn::Set(PixelInts(), skipped)));
  e2.value = hn::Add(e2.value, hn::Mul(e2.step_row, hn::Set(PixelInts(), skipped)));
  PixelVec row = hn::Set(d, static_cast<float>(skipped));
  const std::ptrdiff_t stride = target.stride;
  float* depth = target.nearness + first_row * stride + x;
  const std::int32_t rows = HWY_MIN(setup.end_row[i], target.rows.end) - first_row;
  FragmentCount count(hn::Sub(columns, hn::Set(PixelInts(), first - setup.first_column[i])));
  for (std::int32_t y = 0; y < rows; ++y) {
    const PixelVec z = hn::Add(on_first_row, hn::Mul(per_row, row));
    const PixelIntVec outside = hn::Or(hn::Or(e0.value, e1.value), e2.value);
    if constexpr (counts) count.add(outside);
    draw_block(clamp(z, smallest, largest), outside, depth);
    e0.value = hn::Add(e0.value, e0.step_row);
    e1.value = hn::Add(e1.value, e1.step_row);
    e2.value = hn::Add(e2.value, e2.step_row);
    row = hn::Add(row, hn::Set(d, 1.0F));
    depth += stride;
  }
  return counts ? count.after(rows) : 0;
}

// Returns the number of fragments if `counts`, else 0.
template <bool counts>
HWY_INLINE std::int32_t draw_small(const SetupBatch& setup, std::size_t i, const DepthImage& target) {
  std::int32_t fragments = 0;
  if (!target.rows.meets({setup.first_row[i], setup.end_row[i]})) return fragments;
  for (std::int32_t x = setup.first_column[i]; x < setup.end_column[i]; x += block)
    fragments += draw_columns<counts>(setup, i, HWY_MIN(x, target.width - block), x, target);
  return fragments;
}

// Draws pixels [begin, end) of a row of a large triangle, all within the reach of `depth`. `last` is the last column at
// which a block fits into the image.
HWY_INLINE void draw_span(const DepthRow& depth, const DepthPlane& plane, std::int32_t begin, std::int32_t end,
                          std::int32_t last, float* row) {
  const Pixels d;
  const PixelInts di;
  const PixelVec start = hn::Set(d, depth.start);
  const PixelVec step = hn::Set(d, depth.step);
  const PixelVec smallest = hn::Set(d, plane.smallest);
  const PixelVec largest = hn::Set(d, plane.largest);
  for (std::int32_t from = begin; from < end; from += block) {
    const std::int32_t x = HWY_MIN(from, last);
    const PixelIntVec columns = counting_from(di, x - depth.origin);
    const PixelVec z = hn::Add(start, hn::Mul(step, hn::ConvertTo(d, columns)));
    const PixelIntVec outside = hn::Or(hn::Sub(columns, hn::Set(di, begin - depth.origin)),
                                       hn::Sub(hn::Set(di, end - 1 - depth.origin), columns));
    draw_block(clamp(z, smallest, largest), outside, row + x);
  }
}

// Returns the number of fragments.
HWY_INLINE std::int32_t draw_large(const TriangleBatch& batch, std::size_t i, const DepthImage& target) {
  TriangleSetup setup;
  std::int32_t fragments = 0;
  if (!set_up(batch.screen_vertex(0, i), batch.screen_vertex(1, i), batch.screen_vertex(2, i), target.width,
              target.height, setup))
    return fragments;
  scan(setup, target.width, target.rows, [&](std::int32_t y, std::int32_t begin, std::int32_t end) HWY_ATTR {
    float* row = target.nearness + y * target.stride;
    fragments += end - begin;
    for (std::int32_t from = begin; from < end;) {
      const DepthRow depth = setup.depth_row(from, y);
      const std::int32_t to = HWY_MIN(end, depth.origin + depth_reach);
      draw_span(depth, setup.depth, from, to, target.width - block, row);
      from = to;
    }
  });
  return fragments;
}

template <bool counts>
HWY_INLINE bool draw(const TriangleBatch& batch, const DepthImage& target, DrawnPixels& drawn) {
  if (target.width < block) return false;
  SetupBatch setup;
  BoxLanes around = {hn::Set(Ints(), target.width), hn::Zero(Ints()), hn::Set(Ints(), target.height), hn::Zero(Ints())};
  for (std::size_t i = 0; i < batch.size; i += hn::Lanes(Doubles())) set_up_lanes(batch, i, target, setup, around);
  drawn.rect = united(drawn.rect, reduced(around));
  for (std::size_t i = 0; i < batch.size; ++i) {
    std::int32_t fragments = 0;
    if (setup.kind[i] == small_triangle) {
      fragments = draw_small<counts>(setup, i, target);
    } else if (setup.kind[i] == large_triangle) {
      fragments = draw_large(batch, i, target);
    }
    if constexpr (counts) drawn.fragments += static_cast<std::uint64_t>(fragments);
  }
  return true;
}

bool draw_batch(const TriangleBatch& batch, const DepthImage& target, PixelRect& drawn) {
  DrawnPixels pixels{drawn, 0};
  const bool done = draw<false>(batch, target, pixels);
  drawn = pixels.rect;
  return done;
}

bool draw_batch_counted(const TriangleBatch& batch, const DepthImage& target, DrawnPixels& drawn) {
  return draw<true>(batch, target, drawn);
}

#endif

}  // namespace
}  // namespace occlod::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod::raster {

HWY_EXPORT(draw_batch);
HWY_EXPORT(draw_batch_counted);

bool draw_depth_batch(const TriangleBatch& batch, const DepthImage& target, PixelRect& drawn) {
  return HWY_DYNAMIC_DISPATCH(draw_batch)(batch, target, drawn);
}

bool draw_depth_batch_counted(const TriangleBatch& batch, const DepthImage& target, DrawnPixels& drawn) {
  return HWY_DYNAMIC_DISPATCH(draw_batch_counted)(batch, target, drawn);
}

}  // namespace occlod::raster
#endif  // HWY_ONCE
