// EXT_meshopt_compression of glTF files, by meshoptimizer where the library is built with it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/file_input.h"

namespace occlod {

// What the extension says of a buffer view.
struct MeshoptView {
  std::span<const std::uint8_t> bytes;  // compressed
  std::size_t count = 0;                // of elements
  std::size_t stride = 0;               // bytes of an element
  std::string mode;                     // ATTRIBUTES, TRIANGLES or INDICES
  std::string filter;                   // empty, NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL
};

// count * stride bytes. Throws Error at `place` for a mode or size that the extension does not allow, for data that
// are cut short or damaged, and always in a build without meshoptimizer.
[[nodiscard]] std::vector<std::uint8_t> decode_meshopt(const MeshoptView& view, const std::string& place,
                                                       const FileErrors& errors);

}  // namespace occlod
