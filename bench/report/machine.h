// What a measurement was made on and with.
#pragma once

#include "json_output.h"

namespace occlod::bench {

// date (UTC), version, compiler, build (CMake's type), cpu, cores, system; what this system does not tell is empty.
[[nodiscard]] tool::Json about_this_machine();

}  // namespace occlod::bench
