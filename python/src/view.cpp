// Cameras and views.
#include "occlod/view.h"

#include <nanobind/operators.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>

#include "arrays.h"
#include "bindings.h"

namespace occlod::python {

using namespace nb::literals;

void bind_view(nb::module_& m) {
  const Camera standard;
  nb::class_<Camera>(m, "Camera",
                     "A right-handed camera at `eye` that looks at `target`, in perspective unless it has an\n"
                     "orthographic height. World units; pixels are square. Attributes may be changed.")
      .def(
          "__init__",
          [](Camera* self, glm::dvec3 eye, glm::dvec3 target, glm::dvec3 up, double fov_y_deg, int width, int height,
             double near, double far, std::optional<double> orthographic_height, std::pair<double, double> principal) {
            new (self) Camera{eye,    target, up,  fov_y_deg,           width,
                              height, near,   far, orthographic_height, {principal.first, principal.second}};
          },
          "eye"_a = standard.eye, "target"_a = standard.target, "up"_a = standard.up, nb::kw_only(),
          "fov_y_deg"_a = standard.fov_y_deg, "width"_a = standard.width, "height"_a = standard.height,
          "near"_a = standard.near, "far"_a = standard.far, "orthographic_height"_a = nb::none(),
          "principal_point"_a = std::pair(0.0, 0.0))
      .def_rw("eye", &Camera::eye, "World space.")
      .def_rw("target", &Camera::target, "World space, not the eye.")
      .def_rw("up", &Camera::up, "Of any length, not along the line of sight.")
      .def_rw("fov_y_deg", &Camera::fov_y_deg, "Full vertical angle, in (0, 180).")
      .def_rw("width", &Camera::width, "Pixels, 1 to 16384.")
      .def_rw("height", &Camera::height, "Pixels, 1 to 16384.")
      .def_rw("near", &Camera::near, "Distance to the near plane, > 0.")
      .def_rw("far", &Camera::far, "Distance to the far plane, > near.")
      .def_rw("orthographic_height", &Camera::orthographic_height, nb::arg().none(),
              "World units from the lower to the upper border of the image; None: in perspective.")
      .def_prop_rw(
          "principal_point", [](const Camera& c) { return std::pair(c.principal_point.x, c.principal_point.y); },
          [](Camera& c, std::pair<double, double> p) {
            c.principal_point = {p.first, p.second};
          },
          "Where the line of sight meets the image, from -1 to 1 from left to right and from bottom to top, or\n"
          "beyond; in perspective only.")
      .def("fitting_distance", &fitting_distance, "radius"_a,
           "The distance from which the camera sees all of a sphere of this radius in the middle of its image.")
      .def_static(
          "looking_at",
          [](const nb::object& what, const Camera& camera) {
            std::pair<glm::vec3, glm::vec3> box;
            if (!nb::try_cast(nb::hasattr(what, "box") ? nb::object(what.attr("box")) : what, box))
              throw nb::type_error("looking_at() takes a Hierarchy, an Hlod or two corners of a box");
            return looking_at(Box{box.first, box.second}, camera);
          },
          "what"_a, "camera"_a = standard,
          nb::sig("def looking_at(what: Hierarchy | Hlod | tuple[collections.abc.Sequence[float], "
                  "collections.abc.Sequence[float]], camera: Camera = ...) -> Camera"),
          "A camera that sees all of a hierarchy, of an HLOD or between two corners, from ahead, a little from above\n"
          "and from the right, with the image of `camera`.")
      .def("orthographic", &orthographic, "The same camera with parallel rays, showing as much at its target.")
      .def(nb::self == nb::self);

  nb::class_<View>(m, "View",
                   "What refinement needs to know about a camera. Immutable. Functions that take a View\n"
                   "take a Camera too.")
      .def(nb::init<const Camera&>(), "camera"_a,
           "Error names the camera's field when it is not finite, has no direction or makes no image.")
      .def_prop_ro(
          "camera", [](const View& view) { return view.camera(); }, "A copy.")
      .def_prop_ro("width", &View::width, "Pixels.")
      .def_prop_ro("height", &View::height, "Pixels.")
      .def_prop_ro(
          "direction", [](const View& view) { return view.direction(); },
          "Of the line of sight, unit length, world space.")
      .def_prop_ro("is_orthographic", &View::is_orthographic)
      .def_prop_ro("focal_length_px", &View::focal_length_px,
                   "Pixels that one world unit across the line of sight covers at distance 1.")
      .def_prop_ro(
          "world_to_clip", [](const View& view) { return from_matrix(view.world_to_clip()); },
          nb::sig("def world_to_clip(self) -> numpy.typing.NDArray[numpy.float64]"),
          "(4, 4) float64, to OpenGL's clip space; multiplies columns from the left. A copy.")
      .def("distance_at", &View::distance_at, "nearness"_a,
           "The distance from the eye plane, world units, at which depth images hold this nearness > 0.");
}

}  // namespace occlod::python
