// What Hierarchy and Hlod have alike: they are checked, compared with a mesh, and named in one line.
#pragma once

#include <nanobind/stl/vector.h>

#include "bindings.h"
#include "text.h"

namespace occlod::python {

struct CheckWords {
  const char* require_all;  // docstring
  const char* random;       // keyword of validate()
  const char* restores;     // docstring
};

// require_all(), validate() and restores(). `standard`: the default of validate().
template <typename Number, typename Structure>
void bind_checks(nb::class_<Structure>& type, const CheckWords& words, Number standard) {
  type.def(
          "require_all",
          [](const Structure& structure) {
            const ReleasedGil release;
            structure.require_all();
          },
          words.require_all)
      .def(
          "validate",
          [](const Structure& structure, Number random) {
            const ReleasedGil release;
            return validate(structure, random);
          },
          nb::kw_only(), nb::arg(words.random) = standard, "One line for each violated invariant; none when all hold.")
      .def(
          "restores",
          [](const Structure& structure, const TriangleMesh& mesh) {
            const ReleasedGil release;
            require_valid(mesh);
            return restores(structure, mesh);
          },
          nb::arg("mesh"), words.restores);
}

}  // namespace occlod::python
