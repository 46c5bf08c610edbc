// XXH3-64 of the arguments of calls of a device, by which a replay knows that it is told what was recorded. Equal bits,
// equal digests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "occlod/device/device.h"

namespace occlod::hlod {

class CallDigest {
 public:
  // HLODs by their numbers of nodes and triangles, their box and their bytes of meshes; not by what is in these.
  [[nodiscard]] std::uint64_t of_frame(const View& view, std::span<const PlacedHlod> objects);
  [[nodiscard]] std::uint64_t of_draw(const NodeDraw& draw);
  [[nodiscard]] std::uint64_t of_boxes(std::span<const BoxRef> boxes);
  // Of available, wait and visit.
  [[nodiscard]] std::uint64_t of_number(std::uint64_t number);

 private:
  template <typename T>
  void add_all(std::span<const T> values);
  template <typename T>
  void add(const T& value);
  [[nodiscard]] std::uint64_t finish();

  std::vector<std::byte> bytes_;  // scratch
};

}  // namespace occlod::hlod
