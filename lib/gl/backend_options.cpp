#include "gl/backend_options.h"

#include "occlod/core/error.h"

namespace occlod::gl {

void require_options(const Context* context, std::size_t flight, int divisor, const char* user) {
  if (context == nullptr) throw Error({user, "", "has no OpenGL context", "make one with create_context()"});
  if (flight == 0) throw Error({user, "flight", "is 0", "use at least 1"});
  if (divisor < 1)
    throw Error({user, "divisor", "is " + std::to_string(divisor), "use 1 (the view's own size) or more"});
}

}  // namespace occlod::gl
