// What every OpenGL backend refuses.
#pragma once

#include <cstddef>

#include "occlod/gl/context.h"

namespace occlod::gl {

// Throws Error that names `user` for no context, a flight of 0 or a divisor below 1.
void require_options(const Context* context, std::size_t flight, int divisor, const char* user);

}  // namespace occlod::gl
