#include "raster/draw_bands.h"

#include <algorithm>
#include <array>

#include "base/threads.h"
#include "raster/projection.h"
#include "raster/rasterizer.h"

namespace occlod::raster {
namespace {

// Fewer triangles are not worth another thread.
constexpr std::size_t min_triangles = 8192;
// Bands for each thread, so that all end at about the same time, and the fewest rows of a band.
constexpr int bands_a_thread = 4, min_rows = 8;
constexpr std::size_t triangles_in_a_block = 16 * batch_triangles;

std::size_t triangle_count(std::span<const DrawPart> parts) {
  std::size_t triangles = 0;
  for (const DrawPart& part : parts) triangles += part.triangles.size();
  return triangles;
}

}  // namespace

// Finds the rows of each triangle: all where it has to be clipped.
void BandDrawing::find_rows(std::span<const DrawPart> parts, int width, int height, unsigned threads) {
  rows_.resize(triangle_count(parts));
  std::size_t before = 0;
  for (const DrawPart& part : parts) {
    const Projection projection(part.object_to_clip, width, height);
    const auto row = [&](std::int32_t y) { return static_cast<std::uint16_t>(std::clamp(first_pixel(y), 0, height)); };
    for_each_block(part.triangles.size(), triangles_in_a_block, threads,
                   [&](std::size_t begin, std::size_t end, unsigned) {
                     TriangleBatch batch;
                     for (std::size_t first = begin; first < end; first += batch_triangles) {
                       const std::size_t count = std::min(batch_triangles, end - first);
                       projection.project(part.positions, part.triangles.subspan(first, count), batch);
                       for (std::size_t i = 0; i < count; ++i) {
                         const auto [top, bottom] = std::minmax({batch.y[0][i], batch.y[1][i], batch.y[2][i]});
                         const bool whole = (batch.drawable[0][i] & batch.drawable[1][i] & batch.drawable[2][i]) != 0;
                         rows_[before + first + i] =
                             whole ? Rows{row(top), row(bottom)} : Rows{0, static_cast<std::uint16_t>(height)};
                       }
                     }
                   });
    before += part.triangles.size();
  }
}

template <class Writer>
void BandDrawing::draw_rows(std::span<const DrawPart> parts, int width, int height, const RowRange& rows,
                            const Writer& writer) const {
  std::array<Triangle, batch_triangles> triangles;
  std::array<std::uint32_t, batch_triangles> items;
  const Rows* of_part = rows_.data();
  for (const DrawPart& part : parts) {
    Rasterizer drawing(part.object_to_clip, width, height, writer);
    std::size_t count = 0;
    const auto draw_waiting = [&] {
      if (count > 0) drawing.draw(part.positions, std::span(triangles).first(count), items);
      count = 0;
    };
    for (std::size_t i = 0; i < part.triangles.size(); ++i) {
      if (!rows.meets({of_part[i].first, of_part[i].end})) continue;
      triangles[count] = part.triangles[i];
      items[count] = part.first_item + static_cast<std::uint32_t>(i);
      if (++count == batch_triangles) draw_waiting();
    }
    draw_waiting();
    of_part += part.triangles.size();
  }
}

// `writer(rows, drawn)` makes what writes these rows and extends `drawn`.
template <class MakeWriter>
PixelRect BandDrawing::draw(std::span<const DrawPart> parts, int width, int height, unsigned threads,
                            const MakeWriter& writer) {
  if (threads <= 1 || height == 0 || triangle_count(parts) < min_triangles) {
    DrawnPixels drawn;
    for (const DrawPart& part : parts)
      Rasterizer(part.object_to_clip, width, height, writer(RowRange{}, drawn))
          .draw(part.positions, part.triangles, part.first_item);
    return drawn.rect;
  }
  find_rows(parts, width, height, threads);
  const int bands = bands_a_thread * static_cast<int>(std::min(threads, static_cast<unsigned>(height)));
  const int rows = std::max((height + bands - 1) / bands, min_rows);
  drawn_.assign(static_cast<std::size_t>((height + rows - 1) / rows), {});
  for_each_task(drawn_.size(), threads, [&](std::size_t band) {
    const int first_row = static_cast<int>(band) * rows;
    const RowRange range{first_row, std::min(first_row + rows, height)};
    DrawnPixels drawn;
    draw_rows(parts, width, height, range, writer(range, drawn));
    drawn_[band] = drawn.rect;
  });
  PixelRect all;
  for (const PixelRect& rect : drawn_) all = united(all, rect);
  return all;
}

PixelRect BandDrawing::draw_depth(const DepthImage& target, std::span<const DrawPart> parts, unsigned threads) {
  return draw(parts, target.width, target.height, threads, [&](const RowRange& rows, DrawnPixels& drawn) {
    DepthImage image = target;
    image.rows = rows;
    return DepthWriter<false>{image, &drawn};
  });
}

void BandDrawing::draw_items(ItemBuffer& target, std::span<const DrawPart> parts, unsigned threads) {
  const DepthBuffer& depth = target.depth;
  draw(parts, depth.width, depth.height, threads, [&](const RowRange& rows, DrawnPixels& drawn) {
    return ItemWriter{target.depth.nearness.data(), target.items.data(), static_cast<std::size_t>(depth.width), rows,
                      &drawn};
  });
}

}  // namespace occlod::raster
