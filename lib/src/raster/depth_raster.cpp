#include "raster/depth_raster.h"

#include "raster/scan.h"

// Compiles this file once for every instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "raster/depth_raster.cpp"
#include "hwy/foreach_target.h"
#include "hwy/highway.h"

#ifndef OCCLOD_RASTER_DEPTH_RASTER_ONCE
#define OCCLOD_RASTER_DEPTH_RASTER_ONCE
namespace occlod::raster {

// Triangles of at most this many pixels a side are drawn by edge functions, larger ones by rows. Seen from a corner, a
// pixel of a block is then less than 2^14 + 2 * 16 * 2^8 subpixels away, and edge functions stay below 2^30.
inline constexpr std::int32_t small_triangle_px = 64;

template <class T>
using PerTriangle = std::array<T, batch_triangles>;

// A pixel centre is inside where start + step_column * columns + step_row * rows >= 0, counted from the first pixel of
// the triangle's box.
struct EdgeFunctions {
  PerTriangle<std::int32_t> start, step_column, step_row;
};

// A batch that is set up. Boxes are in the image: [first, end).
struct SetupBatch {
  PerTriangle<std::int32_t> first_column, end_column, first_row, end_row;
  PerTriangle<std::int32_t> kind;      // of TriangleKind
  std::array<EdgeFunctions, 3> edges;  // of small triangles
  PerTriangle<double> at_origin, per_column, per_row;
  PerTriangle<float> smallest, largest;

  [[nodiscard]] DepthPlane plane(std::size_t i) const noexcept {
    return {at_origin[i], per_column[i], per_row[i], smallest[i], largest[i]};
  }
};

enum TriangleKind : std::int32_t { nothing = 0, small_triangle = 1, large_triangle = 2 };

}  // namespace occlod::raster
#endif  // OCCLOD_RASTER_DEPTH_RASTER_ONCE

HWY_BEFORE_NAMESPACE();
namespace occlod::raster::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// ---- Setting up: a triangle to a lane.

using Doubles = hn::ScalableTag<double>;
using Ints = hn::Rebind<std::int32_t, Doubles>;
using Floats = hn::Rebind<float, Doubles>;
using DoubleVec = hn::Vec<Doubles>;
using IntVec = hn::Vec<Ints>;

struct CornerLanes {
  IntVec x, y;
  DoubleVec inverse_w;
};

HWY_INLINE CornerLanes load_corner(const TriangleBatch& batch, std::size_t k, std::size_t i) {
  return {hn::LoadU(Ints(), batch.x[k].data() + i), hn::LoadU(Ints(), batch.y[k].data() + i),
          hn::LoadU(Doubles(), batch.inverse_w[k].data() + i)};
}

template <class V>
HWY_INLINE V smallest_of(V a, V b, V c) {
  return hn::Min(hn::Min(a, b), c);
}

template <class V>
HWY_INLINE V largest_of(V a, V b, V c) {
  return hn::Max(hn::Max(a, b), c);
}

// As first_pixel.
HWY_INLINE IntVec first_pixel_lanes(IntVec subpixel) {
  return hn::ShiftRight<subpixel_bits>(hn::Add(subpixel, hn::Set(Ints(), half_pixel - 1)));
}

HWY_INLINE DoubleVec difference(IntVec a, IntVec b) { return hn::PromoteTo(Doubles(), hn::Sub(a, b)); }

// The edge from a to b of a triangle whose inside is where the function is positive once `flip` (0 or -1) has been
// applied to its sign. Pixel centres on the edge belong to it when it is a top or a left edge.
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

// The arithmetic of depth_plane.
HWY_INLINE void store_plane(const CornerLanes& a, const CornerLanes& b, const CornerLanes& c, DoubleVec twice_area,
                            SetupBatch& setup, std::size_t i) {
  const Doubles d;
  const DoubleVec scale = hn::Div(hn::Set(d, double{subpixels}), twice_area);
  const DoubleVec db = hn::Sub(b.inverse_w, a.inverse_w);
  const DoubleVec dc = hn::Sub(c.inverse_w, a.inverse_w);
  const DoubleVec per_column =
      hn::Mul(hn::Sub(hn::Mul(db, difference(c.y, a.y)), hn::Mul(dc, difference(b.y, a.y))), scale);
  const DoubleVec per_row =
      hn::Mul(hn::Sub(hn::Mul(dc, difference(b.x, a.x)), hn::Mul(db, difference(c.x, a.x))), scale);
  const DoubleVec half = hn::Set(d, 0.5);
  const DoubleVec pixel = hn::Set(d, 1.0 / subpixels);
  const DoubleVec columns = hn::Sub(half, hn::Mul(hn::PromoteTo(d, a.x), pixel));
  const DoubleVec rows = hn::Sub(half, hn::Mul(hn::PromoteTo(d, a.y), pixel));
  const DoubleVec at_origin = hn::Add(hn::Add(a.inverse_w, hn::Mul(per_column, columns)), hn::Mul(per_row, rows));
  hn::StoreU(per_column, d, setup.per_column.data() + i);
  hn::StoreU(per_row, d, setup.per_row.data() + i);
  hn::StoreU(at_origin, d, setup.at_origin.data() + i);
  hn::StoreU(hn::DemoteTo(Floats(), smallest_of(a.inverse_w, b.inverse_w, c.inverse_w)), Floats(),
             setup.smallest.data() + i);
  hn::StoreU(hn::DemoteTo(Floats(), largest_of(a.inverse_w, b.inverse_w, c.inverse_w)), Floats(),
             setup.largest.data() + i);
}

struct BoxLanes {
  IntVec first_column, end_column, first_row, end_row;
};

HWY_INLINE BoxLanes pixel_box(const CornerLanes& a, const CornerLanes& b, const CornerLanes& c,
                              const DepthTarget& target) {
  const Ints d;
  const IntVec zero = hn::Zero(d);
  return {hn::Max(first_pixel_lanes(smallest_of(a.x, b.x, c.x)), zero),
          hn::Min(first_pixel_lanes(largest_of(a.x, b.x, c.x)), hn::Set(d, target.width)),
          hn::Max(first_pixel_lanes(smallest_of(a.y, b.y, c.y)), zero),
          hn::Min(first_pixel_lanes(largest_of(a.y, b.y, c.y)), hn::Set(d, target.height))};
}

// `small` where the triangle's extent, inside the image or not, is that of a small one.
HWY_INLINE IntVec extent(IntVec a, IntVec b, IntVec c) { return hn::Sub(largest_of(a, b, c), smallest_of(a, b, c)); }

HWY_INLINE void set_up_lanes(const TriangleBatch& batch, std::size_t i, const DepthTarget& target, SetupBatch& setup) {
  const Ints d;
  const CornerLanes a = load_corner(batch, 0, i), b = load_corner(batch, 1, i), c = load_corner(batch, 2, i);
  const BoxLanes box = pixel_box(a, b, c, target);
  hn::StoreU(box.first_column, d, setup.first_column.data() + i);
  hn::StoreU(box.end_column, d, setup.end_column.data() + i);
  hn::StoreU(box.first_row, d, setup.first_row.data() + i);
  hn::StoreU(box.end_row, d, setup.end_row.data() + i);

  // Exact: products below 2^48.
  const DoubleVec twice_area =
      hn::Sub(hn::Mul(difference(b.x, a.x), difference(c.y, a.y)), hn::Mul(difference(c.x, a.x), difference(b.y, a.y)));
  store_plane(a, b, c, twice_area, setup, i);
  // -1, 0 or 1.
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
  const auto large = hn::Gt(size, hn::Set(d, small_triangle_px * subpixels));
  const IntVec kind =
      hn::IfThenElse(large, hn::Set(d, std::int32_t{large_triangle}), hn::Set(d, std::int32_t{small_triangle}));
  hn::StoreU(hn::IfThenElseZero(covers, kind), d, setup.kind.data() + i);
}

// ---- Filling: a pixel to a lane.

using Pixels = hn::CappedTag<float, narrowest_simd_image>;
using PixelInts = hn::RebindToSigned<Pixels>;
using PixelVec = hn::Vec<Pixels>;
using PixelIntVec = hn::Vec<PixelInts>;
constexpr int block = static_cast<int>(hn::MaxLanes(Pixels()));

#if HWY_TARGET == HWY_SCALAR
constexpr int half_block = 1;
#else
constexpr int half_block = block / 2;
#endif
using HalfDoubles = hn::CappedTag<double, static_cast<std::size_t>(half_block)>;
using HalfFloats = hn::Rebind<float, HalfDoubles>;
using HalfVec = hn::Vec<HalfDoubles>;

// What the columns of one block add to the plane; unused `high` where a block is one pixel.
struct BlockColumns {
  HalfVec low, high;
};

HWY_INLINE BlockColumns block_columns(double per_column, std::int32_t column) {
  const HalfDoubles d;
  const HalfVec step = hn::Set(d, per_column);
  return {hn::Mul(step, hn::Iota(d, static_cast<double>(column))),
          hn::Mul(step, hn::Iota(d, static_cast<double>(column + half_block)))};
}

// Inverse depth on one row: at_origin + per_row * row is `base`.
HWY_INLINE PixelVec block_depth(HalfVec base, const BlockColumns& columns, PixelVec smallest, PixelVec largest) {
  const HalfFloats half;
#if HWY_TARGET == HWY_SCALAR
  const PixelVec z = hn::DemoteTo(half, hn::Add(base, columns.low));
#else
  const PixelVec z = hn::Combine(Pixels(), hn::DemoteTo(half, hn::Add(base, columns.high)),
                                 hn::DemoteTo(half, hn::Add(base, columns.low)));
#endif
  return hn::Min(hn::Max(z, smallest), largest);
}

struct EdgeLanes {
  PixelIntVec value, step_row;
};

HWY_INLINE EdgeLanes load_edge(const EdgeFunctions& edge, std::size_t i, PixelIntVec columns) {
  const PixelInts d;
  return {hn::Add(hn::Set(d, edge.start[i]), hn::Mul(hn::Set(d, edge.step_column[i]), columns)),
          hn::Set(d, edge.step_row[i])};
}

// All rows of a small triangle in the block of columns from x on.
HWY_INLINE void draw_columns(const SetupBatch& setup, std::size_t i, std::int32_t x, const DepthTarget& target) {
  const Pixels d;
  const PixelIntVec columns = hn::Iota(PixelInts(), x - setup.first_column[i]);
  EdgeLanes e0 = load_edge(setup.edges[0], i, columns);
  EdgeLanes e1 = load_edge(setup.edges[1], i, columns);
  EdgeLanes e2 = load_edge(setup.edges[2], i, columns);
  const BlockColumns along = block_columns(setup.per_column[i], x);
  const HalfDoubles dd;
  const HalfVec at_origin = hn::Set(dd, setup.at_origin[i]);
  const HalfVec per_row = hn::Set(dd, setup.per_row[i]);
  const PixelVec smallest = hn::Set(d, setup.smallest[i]);
  const PixelVec largest = hn::Set(d, setup.largest[i]);
  HalfVec row = hn::Set(dd, static_cast<double>(setup.first_row[i]));
  float* depth = target.inverse_depth + static_cast<std::ptrdiff_t>(setup.first_row[i]) * target.width + x;
  for (std::int32_t y = setup.first_row[i]; y < setup.end_row[i]; ++y) {
    const PixelVec outside = hn::BitCast(d, hn::Or(hn::Or(e0.value, e1.value), e2.value));
    const PixelVec z = block_depth(hn::Add(at_origin, hn::Mul(per_row, row)), along, smallest, largest);
    const PixelVec drawn = hn::IfNegativeThenElse(outside, hn::Zero(d), z);
    hn::StoreU(hn::Max(hn::LoadU(d, depth), drawn), d, depth);
    e0.value = hn::Add(e0.value, e0.step_row);
    e1.value = hn::Add(e1.value, e1.step_row);
    e2.value = hn::Add(e2.value, e2.step_row);
    row = hn::Add(row, hn::Set(dd, 1.0));
    depth += target.width;
  }
}

HWY_INLINE void draw_small(const SetupBatch& setup, std::size_t i, const DepthTarget& target) {
  for (std::int32_t x = setup.first_column[i]; x < setup.end_column[i]; x += block)
    draw_columns(setup, i, HWY_MIN(x, target.width - block), target);
}

// Pixels [begin, end) of the block from x on.
HWY_INLINE void draw_block(const DepthPlane& plane, HalfVec base, std::int32_t x, std::int32_t begin, std::int32_t end,
                           float* row) {
  const Pixels d;
  const PixelInts di;
  const PixelVec z =
      block_depth(base, block_columns(plane.per_column, x), hn::Set(d, plane.smallest), hn::Set(d, plane.largest));
  const PixelIntVec columns = hn::Iota(di, x);
  const PixelIntVec outside = hn::Or(hn::Sub(columns, hn::Set(di, begin)), hn::Sub(hn::Set(di, end - 1), columns));
  const PixelVec drawn = hn::IfNegativeThenElse(hn::BitCast(d, outside), hn::Zero(d), z);
  hn::StoreU(hn::Max(hn::LoadU(d, row + x), drawn), d, row + x);
}

HWY_INLINE void draw_large(const TriangleBatch& batch, std::size_t i, const DepthPlane& plane,
                           const DepthTarget& target) {
  TriangleSetup setup;
  if (!set_up(batch.screen_vertex(0, i), batch.screen_vertex(1, i), batch.screen_vertex(2, i), target.width,
              target.height, setup))
    return;
  scan(setup, target.width, [&](std::int32_t y, std::int32_t begin, std::int32_t end) {
    const HalfVec base = hn::Set(HalfDoubles(), plane.at_origin + plane.per_row * y);
    float* row = target.inverse_depth + static_cast<std::ptrdiff_t>(y) * target.width;
    for (std::int32_t x = begin; x < end; x += block)
      draw_block(plane, base, HWY_MIN(x, target.width - block), begin, end, row);
  });
}

void draw_batch(const TriangleBatch& batch, const DepthTarget& target) {
  SetupBatch setup;
  for (std::size_t i = 0; i < batch.size; i += hn::Lanes(Doubles())) set_up_lanes(batch, i, target, setup);
  for (std::size_t i = 0; i < batch.size; ++i) {
    if (setup.kind[i] == small_triangle) {
      draw_small(setup, i, target);
    } else if (setup.kind[i] == large_triangle) {
      draw_large(batch, i, setup.plane(i), target);
    }
  }
}

}  // namespace occlod::raster::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace occlod::raster {

HWY_EXPORT(draw_batch);

void draw_depth_batch(const TriangleBatch& batch, const DepthTarget& target) {
  HWY_DYNAMIC_DISPATCH(draw_batch)(batch, target);
}

}  // namespace occlod::raster
#endif  // HWY_ONCE
