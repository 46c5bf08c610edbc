// Names the values of options on the command line and in reports.
#pragma once

#include "occlod/cell_builder.h"
#include "occlod/refiner.h"

namespace occlod::tool {

[[nodiscard]] const char* name_of(Method method);
[[nodiscard]] const char* name_of(OccluderMode mode);
[[nodiscard]] const char* name_of(CellOcclusion occlusion);
[[nodiscard]] const char* name_of(CellDivision division);

}  // namespace occlod::tool
