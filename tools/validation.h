// Prints the results of `validate` and `hlod validate`.
#pragma once

#include <string>
#include <vector>

#include "occlod/mesh.h"

namespace occlod::tool {

struct Validation {
  std::string file;
  std::vector<std::string> violations;
  LeftOut left_out;    // of what the file was made from
  std::string source;  // what it was made from: "mesh"
};

// Prints a line for each violation, or one that says that the file is valid; or one JSON object. Then throws Error if
// there are violations.
void report(const Validation& validation, bool json);

}  // namespace occlod::tool
