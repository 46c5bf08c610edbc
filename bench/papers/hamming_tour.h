// An order of columns in which the ones of each row are few runs: Chhugani and others 2003, sec. 3. A shortest tour
// through the columns by Hamming distance, from and to an empty one, has the fewest (Alizadeh and others 1993).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace occlod::paper {

// A sparse matrix of bits by columns. Immutable.
class BitColumns {
 public:
  // `rows`: of each column the rows with a 1, ascending.
  explicit BitColumns(const std::vector<std::vector<std::uint32_t>>& rows);

  [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(first_.size() - 1); }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::uint32_t column) const noexcept {
    return {rows_.data() + first_[column], first_[column + 1] - first_[column]};
  }
  // Rows in which one of the two has a 1 and the other a 0. O(ones).
  [[nodiscard]] std::uint32_t distance(std::uint32_t a, std::uint32_t b) const noexcept;

 private:
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> rows_;
};

using Order = std::vector<std::uint32_t>;  // each column once

// Runs of ones in all rows, the columns in this order: half of the tour's length. O(ones).
[[nodiscard]] std::size_t count_runs(const BitColumns& columns, const Order& order);

// Columns near to each, the nearest first, ties by number.
struct Neighbours {
  std::uint32_t most = 0;  // of each column, at most
  std::vector<std::vector<std::uint32_t>> of;
};
// The `most` nearest. O(n^2 * ones).
[[nodiscard]] Neighbours nearest_columns(const BitColumns& columns, std::uint32_t most);
// The nearest of `sample` columns, the same for all. With a constant share of all columns within twice the distance of
// the nearest one, c log n columns hold one of these for each. O(n * sample * ones).
[[nodiscard]] Neighbours nearest_of_sample(const BitColumns& columns, std::uint32_t most,
                                           std::span<const std::uint32_t> sample);
// `count` different columns, seeded.
[[nodiscard]] std::vector<std::uint32_t> sample_columns(const BitColumns& columns, std::uint32_t count,
                                                        std::uint64_t seed);

// From column 0 always to the nearest neighbour that has not been visited; where none is left, to the nearest column of
// all.
[[nodiscard]] Order greedy_tour(const BitColumns& columns, const Neighbours& neighbours);

// What improve_tour() did.
struct Improvement {
  std::size_t moves = 0;
  std::size_t runs = 0;  // that are left
};
// Shortens the tour by at most `moves` moves of two kinds, each between neighbours: a part is turned round (2-opt), or
// a chain of up to three columns is moved elsewhere, turned round or not (a kind of 3-opt). Ends where none helps.
Improvement improve_tour(const BitColumns& columns, const Neighbours& neighbours, Order& order, std::size_t moves);

}  // namespace occlod::paper
