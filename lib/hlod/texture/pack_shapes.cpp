#include "hlod/texture/pack_shapes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <numeric>

namespace occlod::tiles {

Shape::Shape(int width, int height)
    : width_(width),
      height_(height),
      words_((width + 63) / 64),
      bits_(static_cast<std::size_t>(words_) * static_cast<std::size_t>(height)) {}

void Shape::add(int y, int x0, int x1) noexcept {
  std::uint64_t* const words = bits_.data() + static_cast<std::ptrdiff_t>(y) * words_;
  for (int x = x0; x < x1;) {
    const int first = x % 64, count = std::min(64 - first, x1 - x);
    words[x / 64] |= (~std::uint64_t{0} >> (64 - count)) << first;
    x += count;
  }
}

std::uint64_t Shape::count() const noexcept {
  std::uint64_t sum = 0;
  for (const std::uint64_t word : bits_) sum += static_cast<std::uint64_t>(std::popcount(word));
  return sum;
}

std::span<const std::uint64_t> Shape::row(int y) const noexcept {
  return {bits_.data() + static_cast<std::ptrdiff_t>(y) * words_, static_cast<std::size_t>(words_)};
}

namespace {

// An image that grows downwards, and which squares of it are taken.
class Page {
 public:
  explicit Page(int width) : width_(width), words_(static_cast<std::size_t>(width) / 64 + 2) {}

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return static_cast<int>(bits_.size() / words_); }

  // Puts the shape, no wider than the image, where it fits first, and returns where.
  glm::ivec2 put(const Shape& shape) {
    glm::ivec2 at(0, first_free_row_);
    while (!find_in_row(shape, at)) at = {0, at.y + 1};
    const int bottom = at.y + shape.height();
    if (bottom > height()) bits_.resize(static_cast<std::size_t>(bottom) * words_);
    for (int y = 0; y < shape.height(); ++y) take(shape.row(y), at.x, at.y + y);
    while (first_free_row_ < height() && free_from(0, first_free_row_) >= width_) ++first_free_row_;
    return at;
  }

 private:
  [[nodiscard]] const std::uint64_t* row(int y) const { return bits_.data() + static_cast<std::size_t>(y) * words_; }

  // Returns the first free square of row y from x on; those beyond the image are free.
  [[nodiscard]] int free_from(int x, int y) const {
    const std::uint64_t* const words = row(y);
    const auto at = static_cast<std::size_t>(x);
    std::uint64_t asked = ~std::uint64_t{0} << (at % 64);  // in the word
    for (std::size_t word = at / 64; word < words_; ++word) {
      const std::uint64_t free = ~words[word] & asked;
      if (free != 0) return static_cast<int>(word) * 64 + std::countr_zero(free);
      asked = ~std::uint64_t{0};
    }
    return static_cast<int>(words_) * 64;
  }

  // Moves `at` to the right until the shape fits. Returns whether it does within the width.
  [[nodiscard]] bool find_in_row(const Shape& shape, glm::ivec2& at) const {
    while (at.x + shape.width() <= width_) {
      const int next = next_place(shape, at);
      if (next == at.x) return true;
      at.x = next;
    }
    return false;
  }

  // Returns at.x where the shape fits there, else the next place to the right where it may.
  [[nodiscard]] int next_place(const Shape& shape, const glm::ivec2& at) const {
    for (int y = 0; y < std::min(shape.height(), height() - at.y); ++y) {
      const int square = last_common(shape.row(y), at.x, at.y + y);
      if (square < 0) continue;
      // While any of the run of squares that ends here lies on the run that is taken there, the shape does not fit.
      int run = square;
      while (run > 0 && shape.has(run - 1, y)) --run;
      return free_from(at.x + square, at.y + y) - run;
    }
    return at.x;
  }

  // Returns the last square of a shape's row, put at (x, y), that is taken; -1 for none.
  [[nodiscard]] int last_common(std::span<const std::uint64_t> squares, int x, int y) const {
    const std::uint64_t* const words = row(y) + x / 64;
    const auto shift = static_cast<unsigned>(x % 64);
    for (auto word = static_cast<std::ptrdiff_t>(squares.size()) - 1; word >= 0; --word) {
      const std::uint64_t taken = words[word] >> shift | (shift > 0 ? words[word + 1] << (64 - shift) : 0);
      if (const std::uint64_t common = taken & squares[static_cast<std::size_t>(word)]; common != 0)
        return static_cast<int>(word) * 64 + 63 - std::countl_zero(common);
    }
    return -1;
  }

  void take(std::span<const std::uint64_t> squares, int x, int y) {
    std::uint64_t* const words = bits_.data() + static_cast<std::size_t>(y) * words_ + x / 64;
    const auto shift = static_cast<unsigned>(x % 64);
    for (std::size_t word = 0; word < squares.size(); ++word) {
      words[word] |= squares[word] << shift;
      if (shift > 0) words[word + 1] |= squares[word] >> (64 - shift);
    }
  }

  int width_;
  std::size_t words_;  // a row, with one more than it needs
  std::vector<std::uint64_t> bits_;
  int first_free_row_ = 0;  // those above it are full
};

}  // namespace

Packing pack_shapes(std::span<const Shape> shapes) {
  std::vector<std::uint64_t> counts;
  int widest = 0;
  for (const Shape& shape : shapes) {
    counts.push_back(shape.count());
    widest = std::max(widest, shape.width());
  }
  std::vector<std::size_t> order(shapes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return counts[a] > counts[b]; });
  const double side = std::sqrt(static_cast<double>(std::accumulate(counts.begin(), counts.end(), std::uint64_t{0})));
  Packing best;
  for (const double factor : {0.9, 1.0, 1.1, 1.2, 1.35}) {
    Page page(std::max(widest, static_cast<int>(factor * side)));
    Packing packing;
    packing.at.resize(shapes.size());
    for (const std::size_t i : order) {
      packing.at[i] = page.put(shapes[i]);
      packing.size.x = std::max(packing.size.x, packing.at[i].x + shapes[i].width());
    }
    packing.size.y = page.height();
    const auto squares = [](const Packing& p) { return std::int64_t{p.size.x} * p.size.y; };
    if (best.at.empty() || squares(packing) < squares(best)) best = std::move(packing);
  }
  return best;
}

}  // namespace occlod::tiles
