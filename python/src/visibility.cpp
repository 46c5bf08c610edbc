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

namespace {

using Nearness = nb::ndarray<const float, nb::shape<-1, -1>, nb::c_contig, nb::device::cpu>;

void show(PythonVisibility& self, const Nearness& nearness) {
  auto* software = dynamic_cast<SoftwareOcclusion*>(self.backend.get());
  if (software == nullptr)
    throw Error({"visibility", std::string(self.backend->name()), "takes no pictures", "use \"software\""});
  DepthBuffer depth;
  depth.width = static_cast<int>(nearness.shape(1));
  depth.height = static_cast<int>(nearness.shape(0));
  depth.nearness.assign(nearness.data(), nearness.data() + nearness.size());
  const ReleasedGil release;
  const std::scoped_lock lock(self.in_use);
  software->show(depth);
}

}  // namespace

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
      .def(
          "show", &show, "nearness"_a,
          "Shows \"software\" a picture of the last result, so that the next Refiner.update() need not draw an\n"
          "occluder: 1 / distance from the eye plane of all that is opaque, 0 where nothing is, as\n"
          "ItemBuffer.nearness has it, float32 [height, width], rows from the top. In orthographic views it runs from\n"
          "1 on the near plane to 0 on the far one. Error for another backend, another size, and before the first\n"
          "view.")
      .def("__repr__",
           [](const PythonVisibility& v) { return "occlod.Visibility(\"" + std::string(v.backend->name()) + "\")"; });
}

}  // namespace occlod::python
