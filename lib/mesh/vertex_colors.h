// Colours of vertices while a file is read: what their components go up to is decided once for the whole file.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <limits>
#include <string_view>

#include "mesh/polygon_soup.h"

namespace occlod {

// Names in LeftOut the vertices with a colour component that was clamped.
inline constexpr std::string_view clamped_colors = "colours out of range (clamped)";

// Converts a colour with components in [0, 1]; values outside are clamped. Counts a colour that this changes by more
// than rounding.
[[nodiscard]] inline glm::u8vec4 to_color(const glm::dvec4& unit, std::uint64_t& clamped) {
  constexpr double rounding = 1e-6;
  glm::u8vec4 color;
  bool is_clamped = false;
  for (int k = 0; k < 4; ++k) {
    color[k] = color_component(unit[k]);
    is_clamped |= !(unit[k] >= -rounding && unit[k] <= 1.0 + rounding);
  }
  clamped += is_clamped ? 1U : 0U;
  return color;
}

// Collects colours of which the file does not say whether their components go up to 1 or to 255. They go up to 255
// when any is far above 1: above 2 or, where all are whole numbers, above 1. So components a little above 1 are
// clamped, and whole numbers among fractions have the same scale. Alpha is decided apart from red, green and blue: some
// programs write it up to 1 beside colours up to 255.
template <class Storage>
class VertexColors {
 public:
  static constexpr float no_alpha = std::numeric_limits<float>::infinity();  // of an opaque colour without alpha

  // Adds the colour of vertex number `vertex`; vertices before it that have none become white.
  void add(std::size_t vertex, const glm::vec4& color) {
    pad(vertex);
    values_.push_back(color);
    for (int k = 0; k < 3; ++k) color_range_.add(color[k]);
    if (color.a != no_alpha) alpha_range_.add(color.a);
  }
  // Sets the colours of a soup if any vertex has one, and counts those that were clamped.
  void resolve(BasicPolygonSoup<Storage>& soup) {
    if (values_.empty()) return;
    pad(soup.positions.size());
    const double scale = color_range_.scale(), alpha_scale = alpha_range_.scale();
    std::uint64_t clamped = 0;
    soup.colors.reserve(values_.size());
    for (const glm::vec4& value : values_) {
      glm::dvec4 unit = glm::dvec4(value) * glm::dvec4(scale, scale, scale, alpha_scale);
      if (value.a == no_alpha) unit.a = 1.0;
      soup.colors.push_back(value == none ? glm::u8vec4(255) : to_color(unit, clamped));
    }
    soup.left_out.add(clamped_colors, clamped);
    values_ = {};
  }

 private:
  class Range {
   public:
    void add(float value) {
      largest_ = std::max(largest_, value);  // keeps its first argument when the other is NaN
      has_fractions_ |= value != std::floor(value);
    }
    [[nodiscard]] double scale() const { return largest_ > (has_fractions_ ? 2.0F : 1.0F) ? 1.0 / 255.0 : 1.0; }

   private:
    float largest_ = 0.0F;
    bool has_fractions_ = false;
  };

  void pad(std::size_t vertices) {
    if (values_.size() < vertices) values_.resize(vertices, none);
  }

  static constexpr glm::vec4 none{no_alpha};

  typename Storage::template Array<glm::vec4> values_;  // one per vertex so far
  Range color_range_, alpha_range_;
};

}  // namespace occlod
