#include "hlod/texture/tile_texture.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "hlod/texture/charts.h"

namespace occlod::tiles {
namespace {

// The packer sorts by this, so that rectangles of one size keep their order whatever the C library's qsort() does.
void sort_rectangles(void* rectangles, std::size_t count, std::size_t size, int (*compare)(const void*, const void*)) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  auto* const bytes = static_cast<std::byte*>(rectangles);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return compare(bytes + a * size, bytes + b * size) < 0; });
  const std::vector<std::byte> before(bytes, bytes + count * size);
  for (std::size_t i = 0; i < count; ++i)
    std::copy_n(before.begin() + static_cast<std::ptrdiff_t>(order[i] * size), size, bytes + i * size);
}

}  // namespace
}  // namespace occlod::tiles

#define STBRP_SORT occlod::tiles::sort_rectangles
#define STBRP_STATIC
#define STB_RECT_PACK_IMPLEMENTATION
#include <stb_rect_pack.h>

namespace occlod::tiles {
namespace {

constexpr int max_side = 8192;    // of a tile's image
constexpr int most_coarser = 32;  // sizes by which an image is made coarser, to be no larger
constexpr int oversampling = 2;   // sizes of the source between what is read and what is made
constexpr int most_rounds = 64;   // of filling what the source does not show

int round_up(int value) { return (value + 3) / 4 * 4; }

// A chart, and where it lies in the image of the tile.
struct Placed {
  Chart chart;
  int level = 0;          // size of the source that its texels are as large as
  glm::i64vec2 first{0};  // its first texel at that size
  glm::ivec2 size{0};     // texels, without gutters
  glm::ivec2 at{0};       // of its first texel in the image
};

void choose_level(Placed& placed, const SourceImage& source, double texel_size, int coarser) {
  const int most = static_cast<int>(source.levels.size()) - 1;
  placed.level = std::min(coarser, most);
  // The nearest by ratio: a size is left where the next is nearer to what is asked for.
  for (double middle = placed.chart.texel_size() * std::numbers::sqrt2; placed.level < most && middle < texel_size;
       middle *= 2.0)
    ++placed.level;
  const double scale = std::ldexp(1.0, -placed.level);
  placed.first = placed.chart.first_texel(scale);
  placed.size = glm::ivec2(placed.chart.texel_counts(scale));
}

// Packs into an image of a given width. Returns the height.
int pack(std::vector<stbrp_rect>& rectangles, int width) {
  stbrp_context context;
  std::vector<stbrp_node> nodes(static_cast<std::size_t>(width));
  stbrp_init_target(&context, width, std::numeric_limits<int>::max() / 2, nodes.data(), width);
  stbrp_pack_rects(&context, rectangles.data(), static_cast<int>(rectangles.size()));
  int height = 0;
  for (const stbrp_rect& r : rectangles) height = std::max(height, r.y + r.h);
  return round_up(height);
}

// Packs charts into the smallest image of some that are tried, none much wider than high, and returns its size.
glm::ivec2 pack(std::vector<Placed>& charts) {
  std::vector<stbrp_rect> rectangles, best;
  double area = 0.0;
  int widest = 0;
  for (const Placed& placed : charts) {
    const glm::ivec2 size = placed.size + 2 * gutter;
    rectangles.push_back(
        {.id = static_cast<int>(rectangles.size()), .w = size.x, .h = size.y, .x = 0, .y = 0, .was_packed = 0});
    area += static_cast<double>(size.x) * size.y;
    widest = std::max(widest, size.x);
  }
  glm::ivec2 size(0);
  for (const double factor : {1.0, 1.04, 1.1, 1.2, 1.4}) {
    const int width = std::max(round_up(widest), round_up(static_cast<int>(factor * std::sqrt(area))));
    const int height = pack(rectangles, width);
    if (!best.empty() && std::int64_t{width} * height >= std::int64_t{size.x} * size.y) continue;
    size = {width, height};
    best = rectangles;
  }
  for (std::size_t i = 0; i < charts.size(); ++i) charts[i].at = {best[i].x + gutter, best[i].y + gutter};
  return size;
}

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
      for (Placed& placed : charts_) choose_level(placed, sources_.image(placed.chart.image), texel_size, coarser);
      size_ = pack(charts_);
      if (std::max(size_.x, size_.y) <= max_side || coarser == most_coarser) break;
    }
    pixels_.assign(static_cast<std::size_t>(size_.x) * static_cast<std::size_t>(size_.y), glm::u8vec4(0));
    state_.assign(pixels_.size(), State::empty);
    for (const Placed& placed : charts_) {
      copy(placed);
      move(placed, coordinates);
      if (placed.level > 0 && placed.chart.area > 0.0)
        result.texel_size = std::max(result.texel_size, std::ldexp(placed.chart.texel_size(), placed.level));
    }
    fill();
    result.width = size_.x;
    result.height = size_.y;
    result.pixels = std::move(pixels_);
    result.charts = charts_.size();
    result.is_of_tile.resize(mesh_.materials.size());
    for (std::size_t m = 0; m < result.is_of_tile.size(); ++m)
      result.is_of_tile[m] = sources_.image_of(static_cast<MaterialId>(m)) != no_id ? 1 : 0;
    return result;
  }

 private:
  enum class State : std::uint8_t { empty, wanted, known };

  // A mask over texels of one size of the source.
  struct Mask {
    glm::i64vec2 first;
    glm::i64vec2 size;
    std::vector<std::uint8_t> is_touched;

    [[nodiscard]] std::uint8_t& at(std::int64_t x, std::int64_t y) {
      return is_touched[static_cast<std::size_t>((y - first.y) * size.x + (x - first.x))];
    }
  };

  // Returns the texels of a size of the source that the chart's triangles touch.
  [[nodiscard]] Mask mask_of(const Placed& placed, int level) const {
    const int finer = placed.level - level;
    Mask mask{placed.first << std::int64_t{finer}, glm::i64vec2(placed.size) << std::int64_t{finer}, {}};
    mask.is_touched.assign(static_cast<std::size_t>(mask.size.x * mask.size.y), 0);
    const double scale = std::ldexp(1.0, -level);
    for (const std::uint32_t t : placed.chart.triangles) {
      const Triangle& triangle = mesh_.triangles[t];
      const auto at = [&](int k) { return texels_[triangle[k]] * scale; };
      for_each_touched_row(at(0), at(1), at(2), [&](std::int64_t y, std::int64_t x0, std::int64_t x1) {
        y = std::clamp(y, mask.first.y, mask.first.y + mask.size.y - 1);
        x0 = std::clamp(x0, mask.first.x, mask.first.x + mask.size.x - 1);
        x1 = std::clamp(x1, x0 + 1, mask.first.x + mask.size.x);
        std::fill_n(&mask.at(x0, y), x1 - x0, std::uint8_t{1});
      });
    }
    return mask;
  }

  void copy(const Placed& placed) { placed.level == 0 ? copy_whole(placed) : copy_means(placed); }

  // Copies the texels that triangles touch, and those around each, which filtering reads.
  void copy_whole(const Placed& placed) {
    const SourceImage& source = sources_.image(placed.chart.image);
    const ImageLevel& level = source.levels[0];
    Mask mask = mask_of(placed, 0);
    for (std::int64_t y = 0; y < placed.size.y; ++y)
      for (std::int64_t x = 0; x < placed.size.x; ++x) {
        if (mask.at(placed.first.x + x, placed.first.y + y) == 0) continue;
        for (std::int64_t j = y - 1; j <= y + 1; ++j)
          for (std::int64_t i = x - 1; i <= x + 1; ++i) {
            const std::size_t at = place(placed, i, j);
            if (state_[at] == State::known) continue;
            pixels_[at] = level.pixels[source.at(level, placed.first.x + i, placed.first.y + j)];
            state_[at] = State::known;
          }
      }
  }

  void copy_means(const Placed& placed) {
    const int finer = std::min(placed.level, oversampling);
    const SourceImage& source = sources_.image(placed.chart.image);
    const ImageLevel& level = source.levels[static_cast<std::size_t>(placed.level - finer)];
    Mask mask = mask_of(placed, placed.level - finer);
    const std::int64_t side = std::int64_t{1} << finer;
    for (std::int64_t y = 0; y < placed.size.y; ++y)
      for (std::int64_t x = 0; x < placed.size.x; ++x) {
        const std::int64_t x0 = (placed.first.x + x) * side, y0 = (placed.first.y + y) * side;
        TexelMean mean, touched;
        for (std::int64_t j = y0; j < y0 + side; ++j)
          for (std::int64_t i = x0; i < x0 + side; ++i) {
            if (mask.at(i, j) == 0) continue;
            const std::size_t from = source.at(level, i, j);
            if (level.coverage[from] > 0) mean.add(level.pixels[from], level.coverage[from]);
            touched.add(level.pixels[from], 1.0F);
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
    const double scale = std::ldexp(1.0, -placed.level);
    for (const std::uint32_t t : placed.chart.triangles)
      for (int k = 0; k < 3; ++k) {
        const VertexId v = mesh_.triangles[t][k];
        const glm::dvec2 at = texels_[v] * scale - glm::dvec2(placed.first) + glm::dvec2(placed.at);
        coordinates[v] = sources_.coordinates(at / glm::dvec2(size_));
      }
  }

  // Lets known texels grow over what triangles touch but the input does not show, and as far as gutters reach. Where
  // nothing is known, as of charts thinner than a texel, means of what is there stay; the rest is the mean of all.
  void fill() {
    TexelMean all;
    std::size_t wanted = 0;
    for (std::size_t i = 0; i < state_.size(); ++i) {
      if (state_[i] == State::known) all.add(pixels_[i], 1.0F);
      if (state_[i] == State::wanted) ++wanted;
    }
    for (int round = 0; round < gutter || (wanted > 0 && round < most_rounds); ++round) wanted -= grow(round >= gutter);
    const glm::u8vec4 mean = all.is_empty() ? glm::u8vec4(255) : all.value();
    for (std::size_t i = 0; i < state_.size(); ++i)
      if (state_[i] == State::empty) pixels_[i] = mean;
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
  std::vector<glm::u8vec4> pixels_;
  std::vector<State> state_;  // per pixel
};

}  // namespace

double mean_texel_size(const TriangleMesh& mesh, const SourceTextures& sources) {
  double area = 0.0, texels = 0.0;
  for (const Chart& chart : TileImageMaker(mesh, sources).charts()) {
    area += chart.area;
    texels += chart.texels;
  }
  return texels > 0.0 ? std::sqrt(area / texels) : 0.0;
}

TileImage make_tile_image(TriangleMesh& mesh, const SourceTextures& sources, double texel_size) {
  if (sources.images().empty()) return {};
  std::vector<glm::vec2> coordinates = mesh.texture_coordinates;
  TileImage image = TileImageMaker(mesh, sources).run(texel_size, coordinates);
  mesh.texture_coordinates = std::move(coordinates);
  return image;
}

}  // namespace occlod::tiles
