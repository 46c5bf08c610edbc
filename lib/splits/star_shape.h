// The shape of the faces around one vertex.
#pragma once

#include <cstdint>

namespace occlod {

enum class StarShape : std::uint8_t { closed_fan, open_fan, other };

}  // namespace occlod
