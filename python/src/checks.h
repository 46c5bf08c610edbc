// What Hierarchy and Hlod have alike: they are checked, compared with a mesh, and named in one line.
#pragma once

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <type_traits>

#include "bindings.h"

namespace occlod::python {

struct CheckWords {
  const char* require_all;  // docstring
  const char* random;       // keyword of validate(): its only option
  const char* restores;     // docstring
};

// require_all(), validate() and restores(). `Options` of validate(): one number.
template <typename Options, typename Structure>
void bind_checks(nb::class_<Structure>& type, const CheckWords& words) {
  const auto [standard] = Options{};
  using Number = std::remove_const_t<decltype(standard)>;
  type.def(
          "require_all",
          [](const Structure& structure) {
            const nb::gil_scoped_release release;
            structure.require_all();
          },
          words.require_all)
      .def(
          "validate",
          [](const Structure& structure, Number random) {
            const nb::gil_scoped_release release;
            return validate(structure, Options{random});
          },
          nb::kw_only(), nb::arg(words.random) = standard, "One line for each violated invariant; none when all hold.")
      .def(
          "restores",
          [](const Structure& structure, const TriangleMesh& mesh) {
            const nb::gil_scoped_release release;
            require_valid(mesh);
            return restores(structure, mesh);
          },
          nb::arg("mesh"), words.restores);
}

}  // namespace occlod::python
