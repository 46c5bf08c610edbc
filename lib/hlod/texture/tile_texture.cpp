#include "hlod/texture/tile_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <limits>
#include <utility>

#include "hlod/texture/charts.h"
#include "hlod/texture/pack_shapes.h"
#include "mesh/image_codec.h"

namespace occlod::tiles {
namespace {

constexpr int max_side = 8192;          // of a tile's image
constexpr int most_coarser = 32;        // times that an image's texels are doubled, to be no larger
constexpr int samples = 4;              // along each side of a texel that is a mean
constexpr int most_rounds = 64;         // of filling what the source does not show
constexpr double squares_side = 256;    // of the grid on which charts are packed, about
constexpr double least_scale = 1.0625;  // that is worth making new texels
constexpr double least_gain = 0.9;      // of the area of a chart's box, to turn it

// Directions from 0 to 90 degrees, some 8 degrees apart, of right triangles with whole sides: the same with every
// library of mathematics.
constexpr std::array<glm::dvec2, 12> directions{{{1.0, 0.0},
                                                 {40.0 / 41.0, 9.0 / 41.0},
                                                 {24.0 / 25.0, 7.0 / 25.0},
                                                 {12.0 / 13.0, 5.0 / 13.0},
                                                 {15.0 / 17.0, 8.0 / 17.0},
                                                 {4.0 / 5.0, 3.0 / 5.0},
                                                 {21.0 / 29.0, 20.0 / 29.0},
                                                 {20.0 / 29.0, 21.0 / 29.0},
                                                 {3.0 / 5.0, 4.0 / 5.0},
                                                 {8.0 / 17.0, 15.0 / 17.0},
                                                 {5.0 / 13.0, 12.0 / 13.0},
                                                 {7.0 / 25.0, 24.0 / 25.0}}};

int round_up(int value) { return (value + 3) / 4 * 4; }

// A chart, and where it lies in the image of the tile.
struct Placed {
  Chart chart;
  double scale = 1.0;              // texels of the source along one of the image's; 1: these are copied
  glm::dvec2 direction{1.0, 0.0};  // of the image's rows in the source
  glm::dvec2 first{0.0};           // what `turned` makes of the place of its first texel
  glm::ivec2 size{0};              // texels, without gutters
  glm::ivec2 at{0};                // of its first texel in the image

  // Returns a place of the source, texels, in the turned and scaled grid.
  [[nodiscard]] glm::dvec2 turned(const glm::dvec2& p) const {
    return glm::dvec2(direction.x * p.x + direction.y * p.y, direction.x * p.y - direction.y * p.x) / scale;
  }
  // Returns a place of the source, texels from the chart's first texel of the image.
  [[nodiscard]] glm::dvec2 to_image(const glm::dvec2& p) const { return turned(p) - first; }
  // Returns the reverse.
  [[nodiscard]] glm::dvec2 to_source(const glm::dvec2& p) const {
    const glm::dvec2 q = (p + first) * scale;
    return {direction.x * q.x - direction.y * q.y, direction.x * q.y + direction.y * q.x};
  }
};

class TileImageMaker {
 public:
  TileImageMaker(const TriangleMesh& mesh, const SourceTextures& sources) : mesh_(mesh), sources_(sources) {
    images_.assign(mesh.positions.size(), no_id);
    texels_.assign(mesh.positions.size(), glm::dvec2(0.0));
    if (mesh.texture_coordinates.empty() || sources.images().empty()) return;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const std::uint32_t image = sources.image_of(mesh.material_of(t));
      if (image == no_id) continue;
      for (int k = 0; k < 3; ++k) {
        const VertexId v = mesh.triangles[t][k];
        images_[v] = image;
        texels_[v] = sources.texels(image, mesh.texture_coordinates[v]);
      }
    }
  }

  [[nodiscard]] std::vector<Chart> charts() const {
    return find_charts({mesh_.positions, texels_, images_, mesh_.triangles});
  }

  // Makes the pixels, and moves the texture coordinates in `coordinates`.
  TileImage run(double texel_size, std::vector<glm::vec2>& coordinates) {
    TileImage result;
    for (Chart& chart : charts()) charts_.emplace_back().chart = std::move(chart);
    if (charts_.empty()) return result;
    for (int coarser = 0;; ++coarser) {
      for (Placed& placed : charts_) choose_grid(placed, std::ldexp(texel_size, coarser), std::ldexp(1.0, coarser));
      pack();
      if (std::max(size_.x, size_.y) <= max_side || coarser == most_coarser) break;
    }
    pixels_.assign(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y), glm::u8vec4(0));
    state_.assign(pixels_.size(), State::empty);
    for (const Placed& placed : charts_) {
      copy(placed);
      move(placed, coordinates);
      if (placed.scale > 1.0 && placed.chart.area > 0.0)
        result.texel_size = std::max(result.texel_size, placed.scale * placed.chart.texel_size());
    }
    fill();
    result.width = size_.x;
    result.height = size_.y;
    for (const State state : state_) result.is_free.push_back(state == State::empty ? 1 : 0);
    result.pixels = std::move(pixels_);
    result.charts = charts_.size();
    result.is_of_tile.resize(mesh_.materials.size());
    for (std::size_t m = 0; m < result.is_of_tile.size(); ++m)
      result.is_of_tile[m] = sources_.image_of(static_cast<MaterialId>(m)) != no_id ? 1 : 0;
    for (const std::uint32_t image : images_) result.is_of_vertex.push_back(image != no_id ? 1 : 0);
    return result;
  }

 private:
  enum class State : std::uint8_t { empty, wanted, known };

  // A mask over squares, some of each texel of a chart's part of the image.
  struct Mask {
    glm::i64vec2 size;
    LargeVector<std::uint8_t> is_touched;

    [[nodiscard]] std::uint8_t& at(std::int64_t x, std::int64_t y) {
      return is_touched[static_cast<std::size_t>(y * size.x + x)];
    }
  };

  // Chooses the size of the chart's texels, at least `least` of its source's, and for new ones the direction in which
  // the chart has the smallest box.
  void choose_grid(Placed& placed, double texel_size, double least) const {
    const glm::dvec2 extent = placed.chart.max - placed.chart.min;
    double texels = texel_size > 0.0 ? texel_size / placed.chart.texel_size() : 1.0;
    if (texels < least_scale) texels = 1.0;
    placed.scale = std::min(std::max(texels, least), std::max({1.0, extent.x, extent.y}));
    placed.direction = directions[0];
    set_box(placed);
    if (placed.scale == 1.0) return;
    Placed turned = placed;
    const auto area = [](const Placed& p) {
      return static_cast<double>(p.size.x + 2 * gutter) * (p.size.y + 2 * gutter);
    };
    for (const glm::dvec2& direction : directions) {
      turned.direction = direction;
      set_box(turned);
      if (area(turned) < (placed.direction == directions[0] ? least_gain : 1.0) * area(placed)) {
        placed.direction = turned.direction;
        placed.first = turned.first;
        placed.size = turned.size;
      }
    }
  }

  void set_box(Placed& placed) const {
    glm::dvec2 low(std::numeric_limits<double>::infinity()), high(-low);
    for (const std::uint32_t t : placed.chart.triangles)
      for (int k = 0; k < 3; ++k) {
        const glm::dvec2 at = placed.turned(texels_[mesh_.triangles[t][k]]);
        low = glm::min(low, at);
        high = glm::max(high, at);
      }
    placed.first = placed.scale == 1.0 ? glm::floor(low) : low;
    placed.size = glm::max(glm::ivec2(glm::ceil(high - placed.first)), glm::ivec2(1));
  }

  // Packs what the charts' triangles touch, with gutters, on a grid of squares that are the coarser the larger the
  // image is.
  void pack() {
    double texels = 0.0;
    for (const Placed& placed : charts_)
      texels += static_cast<double>(placed.size.x + 2 * gutter) * (placed.size.y + 2 * gutter);
    const int side = std::max(1, static_cast<int>(std::sqrt(texels) / squares_side));
    std::vector<Shape> shapes;
    for (const Placed& placed : charts_) shapes.push_back(shape_of(placed, side));
    const Packing packing = pack_shapes(shapes);
    for (std::size_t i = 0; i < charts_.size(); ++i) charts_[i].at = side * packing.at[i] + gutter;
    size_ = {round_up(side * packing.size.x), round_up(side * packing.size.y)};
  }

  // Returns the squares of some texels' side that hold what the triangles touch, and gutters.
  [[nodiscard]] Shape shape_of(const Placed& placed, int side) const {
    const glm::ivec2 squares = (placed.size + 2 * gutter + side - 1) / side;
    Shape shape(squares.x, squares.y);
    for_each_touched(placed, 1, [&](int y, int x0, int x1) {
      for (int row = y / side; row <= (y + 2 * gutter) / side; ++row)
        shape.add(row, x0 / side, (x1 - 1 + 2 * gutter) / side + 1);
    });
    return shape;
  }

  // Calls visit(y, x0, x1) for rows [x0, x1) of squares that triangles touch, `parts` a texel, within the chart's box.
  template <typename Visit>
  void for_each_touched(const Placed& placed, int parts, const Visit& visit) const {
    const glm::i64vec2 last(parts * placed.size - 1);
    for (const std::uint32_t t : placed.chart.triangles) {
      const auto at = [&](int k) {
        return placed.to_image(texels_[mesh_.triangles[t][k]]) * static_cast<double>(parts);
      };
      for_each_touched_row(at(0), at(1), at(2), [&](std::int64_t y, std::int64_t x0, std::int64_t x1) {
        x0 = std::clamp<std::int64_t>(x0, 0, last.x);
        visit(static_cast<int>(std::clamp<std::int64_t>(y, 0, last.y)), static_cast<int>(x0),
              static_cast<int>(std::clamp(x1, x0 + 1, last.x + 1)));
      });
    }
  }

  [[nodiscard]] Mask mask_of(const Placed& placed, int parts) const {
    Mask mask{glm::i64vec2(parts * placed.size), {}};
    mask.is_touched.assign(static_cast<std::size_t>(mask.size.x * mask.size.y), 0);
    for_each_touched(placed, parts,
                     [&](int y, int x0, int x1) { std::fill_n(&mask.at(x0, y), x1 - x0, std::uint8_t{1}); });
    return mask;
  }

  void copy(const Placed& placed) { placed.scale == 1.0 ? copy_whole(placed) : copy_means(placed); }

  // Copies the texels that triangles touch, and those around each, which filtering reads.
  void copy_whole(const Placed& placed) {
    const SourceImage& source = sources_.image(placed.chart.image);
    const ImageLevel& level = source.levels[0];
    const glm::i64vec2 first(placed.first);
    Mask mask = mask_of(placed, 1);
    for (std::int64_t y = 0; y < placed.size.y; ++y)
      for (std::int64_t x = 0; x < placed.size.x; ++x) {
        if (mask.at(x, y) == 0) continue;
        for (std::int64_t j = y - 1; j <= y + 1; ++j)
          for (std::int64_t i = x - 1; i <= x + 1; ++i) {
            const std::size_t at = place(placed, i, j);
            if (state_[at] == State::known) continue;
            pixels_[at] = level.pixels[source.at(level, first.x + i, first.y + j)];
            state_[at] = State::known;
          }
      }
  }

  // Makes each texel the mean of what the source shows at places of it that triangles touch.
  void copy_means(const Placed& placed) {
    const SourceImage& source = sources_.image(placed.chart.image);
    // Samples are no farther apart than texels of this size of the source.
    std::size_t size = 0;
    double texel = 1.0;
    for (; size + 1 < source.levels.size() && texel * samples < placed.scale; texel *= 2.0) ++size;
    const ImageLevel& level = source.levels[size];
    Mask mask = mask_of(placed, samples);
    for (int y = 0; y < placed.size.y; ++y)
      for (int x = 0; x < placed.size.x; ++x) {
        TexelMean mean, touched;
        for (int j = samples * y; j < samples * (y + 1); ++j)
          for (int i = samples * x; i < samples * (x + 1); ++i) {
            if (mask.at(i, j) == 0) continue;
            const glm::dvec2 from = placed.to_source((glm::dvec2(i, j) + 0.5) / static_cast<double>(samples)) / texel;
            const std::size_t at = source.at(level, std::llround(std::floor(from.x)), std::llround(std::floor(from.y)));
            if (level.coverage[at] > 0) mean.add(level.pixels[at], level.coverage[at]);
            touched.add(level.pixels[at], 1.0F);
          }
        if (touched.is_empty()) continue;
        const std::size_t at = place(placed, x, y);
        state_[at] = mean.is_empty() ? State::wanted : State::known;
        pixels_[at] = mean.is_empty() ? touched.value() : mean.value();
      }
  }

  [[nodiscard]] std::size_t place(const Placed& placed, std::int64_t x, std::int64_t y) const {
    return static_cast<std::size_t>((placed.at.y + y) * size_.x + placed.at.x + x);
  }

  void move(const Placed& placed, std::vector<glm::vec2>& coordinates) const {
    for (const std::uint32_t t : placed.chart.triangles)
      for (int k = 0; k < 3; ++k) {
        const VertexId v = mesh_.triangles[t][k];
        const glm::dvec2 at = placed.to_image(texels_[v]) + glm::dvec2(placed.at);
        coordinates[v] = sources_.coordinates(at / glm::dvec2(size_));
      }
  }

  // Lets known texels grow over what triangles touch but the input does not show, and, where texels are means, once
  // around, as filtering needs it. Where nothing is known, as of charts thinner than a texel, means of what is there
  // stay.
  void fill() {
    std::size_t wanted = 0;
    for (const State state : state_) wanted += state == State::wanted ? 1 : 0;
    for (int round = 0; wanted > 0 && round < most_rounds; ++round) wanted -= grow(true);
    if (std::ranges::any_of(charts_, [](const Placed& placed) { return placed.scale > 1.0; })) grow(false);
  }

  // Fills each texel that has known neighbours with their mean, if triangles touch it or all are asked for. Returns how
  // many were wanted.
  std::size_t grow(bool only_wanted) {
    std::vector<std::pair<std::size_t, glm::u8vec4>> grown;
    std::size_t wanted = 0;
    for (int y = 0; y < size_.y; ++y)
      for (int x = 0; x < size_.x; ++x) {
        const std::size_t at =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.x) + static_cast<std::size_t>(x);
        if (state_[at] == State::known || (only_wanted && state_[at] != State::wanted)) continue;
        TexelMean mean;
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, size_.y - 1); ++j)
          for (int i = std::max(x - 1, 0); i <= std::min(x + 1, size_.x - 1); ++i) {
            const std::size_t from =
                static_cast<std::size_t>(j) * static_cast<std::size_t>(size_.x) + static_cast<std::size_t>(i);
            if (state_[from] == State::known) mean.add(pixels_[from], 1.0F);
          }
        if (mean.is_empty()) continue;
        grown.emplace_back(at, mean.value());
        if (state_[at] == State::wanted) ++wanted;
      }
    for (const auto& [at, pixel] : grown) {
      pixels_[at] = pixel;
      state_[at] = State::known;
    }
    return wanted;
  }

  const TriangleMesh& mesh_;
  const SourceTextures& sources_;
  std::vector<std::uint32_t> images_;  // per vertex
  std::vector<glm::dvec2> texels_;     // per vertex, in its image
  std::vector<Placed> charts_;
  glm::ivec2 size_{0};
  LargeVector<glm::u8vec4> pixels_;
  LargeVector<State> state_;  // per pixel
};

}  // namespace

ShownTexels shown_texels(const TriangleMesh& mesh, const SourceTextures& sources) {
  double area = 0.0, texels = 0.0;
  const std::vector<Chart> charts = TileImageMaker(mesh, sources).charts();
  for (const Chart& chart : charts) {
    area += chart.area;
    texels += chart.texels;
  }
  return {texels > 0.0 ? std::sqrt(area / texels) : 0.0, charts.size()};
}

TileImage make_tile_image(TriangleMesh& mesh, const SourceTextures& sources, double texel_size) {
  if (sources.images().empty()) return {};
  std::vector<glm::vec2> coordinates = mesh.texture_coordinates;
  TileImage image = TileImageMaker(mesh, sources).run(texel_size, coordinates);
  mesh.texture_coordinates = std::move(coordinates);
  return image;
}

namespace {

// Gives free pixels the colour to their left, else that of the first to their right that is not free: in a PNG they
// then take next to no bytes.
void repeat_in_rows(TileImage& image) {
  glm::u8vec4 last(0, 0, 0, 255);
  for (std::size_t first = 0; first < image.pixels.size(); first += static_cast<std::size_t>(image.width)) {
    const std::size_t end = first + static_cast<std::size_t>(image.width);
    for (std::size_t i = first; i < end; ++i)
      if (image.is_free[i] == 0) {
        last = image.pixels[i];
        break;
      }
    for (std::size_t i = first; i < end; ++i) {
      if (image.is_free[i] == 0)
        last = image.pixels[i];
      else
        image.pixels[i] = last;
    }
  }
}

// Gives free pixels the mean colour of their block, or of the one before where all are free: a JPEG codes blocks, and
// flat ones take next to no bytes.
void level_in_blocks(TileImage& image) {
  constexpr int block = 16;
  glm::u8vec4 mean(128, 128, 128, 255);
  for (int top = 0; top < image.height; top += block)
    for (int left = 0; left < image.width; left += block) {
      const auto for_each = [&](const auto& visit) {
        for (int y = top; y < std::min(top + block, image.height); ++y)
          for (int x = left; x < std::min(left + block, image.width); ++x)
            visit(static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
      };
      glm::uvec4 sum(0);
      std::uint32_t count = 0;
      for_each([&](std::size_t i) {
        if (image.is_free[i] != 0) return;
        sum += glm::uvec4(image.pixels[i]);
        ++count;
      });
      if (count > 0) mean = glm::u8vec4(sum / count);
      for_each([&](std::size_t i) {
        if (image.is_free[i] != 0) image.pixels[i] = mean;
      });
    }
}

}  // namespace

std::vector<std::uint8_t> encode(TileImage image, TextureFormat format) {
  bool is_jpeg = format == TextureFormat::jpeg;
  for (std::size_t i = 0; is_jpeg && i < image.pixels.size(); ++i)
    is_jpeg = image.is_free[i] != 0 || image.pixels[i].a == 255;
  is_jpeg ? level_in_blocks(image) : repeat_in_rows(image);
  return is_jpeg ? encode_jpeg(image.pixels, image.width) : encode_png(image.pixels, image.width);
}

}  // namespace occlod::tiles
