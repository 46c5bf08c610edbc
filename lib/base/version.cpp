#include "occlod/core/version.h"

namespace occlod {

const char* version() noexcept { return OCCLOD_VERSION; }

}  // namespace occlod
