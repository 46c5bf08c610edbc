// Positions wherever they are kept.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "occlod/core/ids.h"

namespace occlod {

// Does not own them; of an array of positions, or of records that hold one each.
class PositionView {
 public:
  PositionView(std::span<const glm::vec3> positions) : first_(positions.data()), stride_(sizeof(glm::vec3)) {}
  PositionView(const std::vector<glm::vec3>& positions) : PositionView(std::span(positions)) {}
  template <typename Record>
  PositionView(std::span<const Record> records, glm::vec3 Record::*member)
      : first_(records.empty() ? nullptr : &(records[0].*member)), stride_(sizeof(Record)) {}

  const glm::vec3& operator[](std::size_t v) const noexcept {
    return *reinterpret_cast<const glm::vec3*>(reinterpret_cast<const std::byte*>(first_) + v * stride_);
  }

 private:
  const glm::vec3* first_;
  std::size_t stride_;
};

}  // namespace occlod
