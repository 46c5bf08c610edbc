// What `validate` and `hlod validate` print.
#pragma once

#include <string>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::tool {

struct Validation {
  std::string file;
  std::vector<std::string> violations;
  LeftOut left_out;    // of what the file was made from,
  std::string source;  // which is called this: "mesh"
};

// A line for each violation, or one that says that the file is valid; or one JSON object. Throws Error where there are
// violations, after that.
void report(const Validation& validation, bool json);

}  // namespace occlod::tool
