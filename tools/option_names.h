// What options are called on the command line and in every report.
#pragma once

#include "occlod/refine/refiner.h"

namespace occlod::tool {

[[nodiscard]] const char* name_of(Culling culling);
[[nodiscard]] const char* name_of(OccluderMode mode);
[[nodiscard]] const char* name_of(Proxy proxy);

}  // namespace occlod::tool
