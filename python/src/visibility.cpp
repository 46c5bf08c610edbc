// Visibility backends by name.
#include "occlod/visibility.h"

#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include "bindings.h"
#include "refining.h"
#include "text.h"
#ifdef OCCLOD_HAS_GL
#include "occlod/gl.h"
#endif

namespace occlod::python {
namespace {

using namespace nb::literals;

#ifdef OCCLOD_HAS_GL
constexpr bool has_gl = true;

std::unique_ptr<Visibility> make_gl(const std::string& /*name*/) {
  return gl::make_query_occlusion(gl::create_any_context());
}
#else
constexpr bool has_gl = false;

std::unique_ptr<Visibility> make_gl(const std::string& name) {
  throw Error({name, "", "this package was built without OpenGL",
               "use \"software\", or build it with --config-settings cmake.define.OCCLOD_PYTHON_GL=ON"});
}
#endif

std::vector<std::string> visibility_names() {
  std::vector<std::string> names = {"software", "none"};
  if (has_gl) names.emplace_back("gl-query");
  return names;
}

}  // namespace

std::unique_ptr<Visibility> make_visibility(const std::string& name) {
  if (name == "software") return make_software_occlusion();
  if (name == "none") return std::make_unique<NoOcclusion>();
  if (name == "gl-query") return make_gl(name);
  throw Error({"visibility", name, "is no backend", "use one of visibility_names()"});
}

void bind_visibility(nb::module_& m) {
  m.def("visibility_names", &visibility_names, "Of the backends that this package was built with.");
  nb::class_<PythonVisibility>(
      m, "Visibility",
      "Answers what is hidden. Several refiners may use one in turn; a GL backend belongs to the\n"
      "thread that made it.")
      .def(nb::new_([](const std::string& name) {
             auto made = std::make_shared<PythonVisibility>();
             made->backend = make_visibility(name);
             return made;
           }),
           "name"_a = "software",
           "\"software\"; \"none\"; and, where visibility_names() has it, \"gl-query\".\n"
           "Error for another name, and where no OpenGL context can be had.")
      .def_prop_ro("name", [](const PythonVisibility& v) { return std::string(v.backend->name()); })
      .def_prop_ro("can_hide", [](const PythonVisibility& v) { return v.backend->can_hide(); })
      .def("__repr__",
           [](const PythonVisibility& v) { return "occlod.Visibility(\"" + std::string(v.backend->name()) + "\")"; });
}

}  // namespace occlod::python
