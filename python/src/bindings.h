// The parts of the module, each in a source of its own, and what they share.
#pragma once

#include <nanobind/nanobind.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gil.h"
#include "occlod/base.h"
#include "occlod/hierarchy.h"
#include "occlod/mesh.h"
#include "occlod/picture.h"
#include "occlod/visibility.h"

namespace occlod::python {

namespace nb = nanobind;

void bind_materials(nb::module_& m);
void bind_mesh(nb::module_& m);
void bind_simplify(nb::module_& m);
void bind_hierarchy(nb::module_& m);
void bind_view(nb::module_& m);
void bind_options(nb::module_& m);
void bind_visibility(nb::module_& m);
void bind_refiner(nb::module_& m);
void bind_auto_refiner(nb::module_& m);
void bind_scene(nb::module_& m);
void bind_picture(nb::module_& m);
void bind_hlod(nb::module_& m);
void bind_tiles(nb::module_& m);
void bind_device(nb::module_& m);
void bind_traverse(nb::module_& m);
void bind_select(nb::module_& m);
void bind_cells(nb::module_& m);
void bind_cell_files(nb::module_& m);
void bind_cell_walker(nb::module_& m);

// A hierarchy at a place.
struct PlacedObject {
  Hierarchy hierarchy;
  glm::dmat4 object_to_world{1.0};
  bool two_sided = false;
  std::string source_name;  // for people; may be empty
  bool attributes = true;   // see RefineObject
};

// Draws something of an array that `owners` keep alive.
struct PythonDrawObject {
  DrawObject draw;
  std::vector<nb::object> owners;
};

// For work that is long: lets Ctrl-C end it, and calls `progress` unless it is None. Call without the GIL; `progress`
// lives as long as what is returned. Holds no reference: it may be copied without the GIL.
[[nodiscard]] std::function<bool(double)> progress_of(nb::handle progress);

// Throws Error unless every optional array is empty or has one entry for each wedge or triangle, and every index is in
// range. O(n).
void require_valid(const TriangleMesh& mesh);

// A backend by its name: "software", "none" or "gl-query".
[[nodiscard]] std::unique_ptr<Visibility> make_visibility(const std::string& name);

}  // namespace occlod::python
