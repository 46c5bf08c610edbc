#include "cells/cell_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "occlod/core/error.h"

namespace occlod {
namespace {

constexpr unsigned hilbert_bits = 21;
constexpr double most_root_cells = 1U << 24U;

double edge(const CellBox& box, int axis) { return box.max[axis] - box.min[axis]; }

// The i-th of n + 1 planes that cut the box into n.
double plane(const CellBox& box, int axis, std::uint32_t i, std::uint32_t n) {
  return i == n ? box.max[axis] : box.min[axis] + edge(box, axis) * (static_cast<double>(i) / n);
}

std::array<std::uint32_t, 3> counts_of(const CellBox& region, double root_cell) {
  std::array<double, 3> counts{};
  for (int axis = 0; axis < 3; ++axis)  // rounding makes no cell more
    counts[static_cast<std::size_t>(axis)] = std::max(1.0, std::ceil(edge(region, axis) / root_cell - 1e-9));
  if (!(counts[0] * counts[1] * counts[2] <= most_root_cells) ||
      *std::max_element(counts.begin(), counts.end()) > static_cast<double>(1U << hilbert_bits))
    throw Error({"cell options", "root_cell",
                 fmt::format("{} cuts a region into more than {} cells", root_cell, most_root_cells),
                 "make root cells larger, or the region smaller"});
  return {static_cast<std::uint32_t>(counts[0]), static_cast<std::uint32_t>(counts[1]),
          static_cast<std::uint32_t>(counts[2])};
}

}  // namespace

std::uint64_t hilbert_index(std::array<std::uint32_t, 3> x) {
  constexpr std::uint32_t top = 1U << (hilbert_bits - 1);
  for (std::uint32_t q = top; q > 1; q >>= 1U) {
    const std::uint32_t p = q - 1;
    for (std::uint32_t& axis : x) {
      if ((axis & q) != 0) {
        x[0] ^= p;
      } else {
        const std::uint32_t t = (x[0] ^ axis) & p;
        x[0] ^= t;
        axis ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t t = 0;
  for (std::uint32_t q = top; q > 1; q >>= 1U)
    if ((x[2] & q) != 0) t ^= q - 1;
  std::uint64_t index = 0;
  for (unsigned bit = hilbert_bits; bit-- > 0;)
    for (const std::uint32_t axis : x) index = index << 1U | (((axis ^ t) >> bit) & 1U);
  return index;
}

std::vector<RootCell> root_cells(const CellTreeOptions& options) {
  std::vector<RootCell> cells;
  for (std::uint32_t r = 0; r < options.regions.size(); ++r) {
    const CellBox& region = options.regions[r];
    const auto [nx, ny, nz] = counts_of(region, options.root_cell);
    const std::size_t first = cells.size();
    for (std::uint32_t z = 0; z < nz; ++z)
      for (std::uint32_t y = 0; y < ny; ++y)
        for (std::uint32_t x = 0; x < nx; ++x)
          cells.push_back({{{plane(region, 0, x, nx), plane(region, 1, y, ny), plane(region, 2, z, nz)},
                            {plane(region, 0, x + 1, nx), plane(region, 1, y + 1, ny), plane(region, 2, z + 1, nz)}},
                           r,
                           {x, y, z}});
    if (static_cast<double>(cells.size()) > most_root_cells)
      throw Error({"cell options", "regions", fmt::format("have more than {} root cells", most_root_cells),
                   "make root cells larger"});
    std::sort(cells.begin() + static_cast<std::ptrdiff_t>(first), cells.end(),
              [](const RootCell& a, const RootCell& b) { return hilbert_index(a.place) < hilbert_index(b.place); });
  }
  return cells;
}

std::vector<CellBox> parts_of(const CellBox& box, double smallest) {
  constexpr double long_enough = 0.7;  // of the longest axis
  const double longest = std::max({edge(box, 0), edge(box, 1), edge(box, 2)});
  std::vector<CellBox> parts = {box};
  for (int axis = 2; axis >= 0; --axis) {
    const double half = 0.5 * edge(box, axis);
    if (!(edge(box, axis) > long_enough * longest) || half < smallest) continue;
    const double middle = box.min[axis] + half;
    std::vector<CellBox> halves;
    for (const CellBox& part : parts) {
      halves.push_back(part);
      halves.back().max[axis] = middle;
      halves.push_back(part);
      halves.back().min[axis] = middle;
    }
    parts = std::move(halves);
  }
  return parts;
}

}  // namespace occlod
