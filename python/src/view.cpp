// Cameras and views.
#include "occlod/view.h"

#include <nanobind/operators.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>

#include <cmath>
#include <sstream>
#include <string>
#include <tuple>

#include "arrays.h"
#include "bindings.h"
#include "occlod/hlod.h"
#include "text.h"

namespace occlod::python {

using namespace nb::literals;

namespace {

using CameraState = std::tuple<glm::dvec3, glm::dvec3, glm::dvec3, double, int, int, double, double,
                               std::optional<double>, std::pair<double, double>>;

Camera camera_of(const CameraState& state) {
  const auto& [eye, target, up, fov_y_deg, width, height, near, far, orthographic_height, principal] = state;
  return {eye,    target, up,  fov_y_deg,           width,
          height, near,   far, orthographic_height, {principal.first, principal.second}};
}

std::string describe(const Camera& camera) {
  std::ostringstream text;
  const auto write = [&text](const glm::dvec3& p) { text << "(" << p.x << ", " << p.y << ", " << p.z << ")"; };
  text << "<occlod.Camera at ";
  write(camera.eye);
  text << " that looks at ";
  write(camera.target);
  text << ", " << camera.width << " x " << camera.height << " pixels>";
  return text.str();
}

// Two corners, in coordinates.
std::pair<glm::dvec3, glm::dvec3> corners_of(const nb::object& what) {
  const auto moved = [](const Box& box, const glm::dvec3& origin) {
    return std::pair(glm::dvec3(box.min) + origin, glm::dvec3(box.max) + origin);
  };
  if (nb::isinstance<TriangleMesh>(what)) {
    const TriangleMesh& mesh = nb::cast<const TriangleMesh&>(what);
    if (mesh.positions.empty()) throw Error({"mesh", "", "has no vertices", "give one to look at"});
    return moved(bounding_box(mesh.positions), mesh.origin);
  }
  if (nb::isinstance<Hierarchy>(what)) {
    const Hierarchy& hierarchy = nb::cast<const Hierarchy&>(what);
    return moved(hierarchy.box(), hierarchy.data().origin);
  }
  if (nb::isinstance<hlod::Hlod>(what)) {
    const hlod::HlodView& data = nb::cast<const hlod::Hlod&>(what).data();
    return moved(data.box, data.origin);
  }
  std::pair<glm::dvec3, glm::dvec3> corners;
  if (!nb::try_cast(what, corners))
    throw nb::type_error("looking_at() takes a Mesh, a Hierarchy, an Hlod or two corners of a box");
  return corners;
}

// Turns the camera around its target until it looks that way.
void turn(Camera& camera, const glm::dvec3& direction) {
  const double length = glm::length(direction);
  if (!std::isfinite(length) || !(length > 0.0))
    throw nb::value_error("direction: has no length; give three numbers of which one is not 0");
  const glm::dvec3 way = direction / length;
  camera.eye = camera.target - glm::distance(camera.eye, camera.target) * way;
  const auto is_along = [&way](const glm::dvec3& up) {
    return glm::length(glm::cross(way, up)) < 1e-6 * glm::length(up);
  };
  for (const glm::dvec3 other : {glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(0.0, 0.0, -1.0)})
    if (is_along(camera.up)) camera.up = other;
}

Camera looking_at_any(const nb::object& what, Camera camera, std::optional<glm::dvec3> direction,
                      std::optional<int> width, std::optional<int> height, std::optional<double> fov_y_deg) {
  camera.width = width.value_or(camera.width);
  camera.height = height.value_or(camera.height);
  camera.fov_y_deg = fov_y_deg.value_or(camera.fov_y_deg);
  const auto [low, high] = corners_of(what);
  camera = looking_at((low + high) / 2.0, glm::distance(low, high) / 2.0, camera);
  if (direction) turn(camera, *direction);
  return camera;
}

}  // namespace

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
          "looking_at", &looking_at_any, "what"_a, "camera"_a = standard, nb::kw_only(), "direction"_a = nb::none(),
          "width"_a = nb::none(), "height"_a = nb::none(), "fov_y_deg"_a = nb::none(),
          nb::sig("def looking_at(what: Mesh | Hierarchy | Hlod | tuple[collections.abc.Sequence[float], "
                  "collections.abc.Sequence[float]], camera: Camera = ..., *, "
                  "direction: collections.abc.Sequence[float] | None = None, width: int | None = None, "
                  "height: int | None = None, fov_y_deg: float | None = None) -> Camera"),
          "A camera that sees all of a mesh, a hierarchy or an HLOD at its coordinates, or between two corners,\n"
          "with the image of `camera`, but for what is given here: along `direction`, or from ahead, a little\n"
          "from above and from the right. Where `camera` has its `up` along it, y is up, or -z. ValueError for a\n"
          "direction of no length.")
      .def("orthographic", &orthographic, "The same camera with parallel rays, showing as much at its target.")
      .def(nb::self == nb::self)
      .def("__getstate__",
           [](const Camera& c) {
             return CameraState(c.eye, c.target, c.up, c.fov_y_deg, c.width, c.height, c.near, c.far,
                                c.orthographic_height, std::pair(c.principal_point.x, c.principal_point.y));
           })
      .def("__setstate__", [](Camera& self, const CameraState& state) { new (&self) Camera(camera_of(state)); })
      .def("__repr__", &describe);

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
      .def("__getstate__", [](const View& view) { return std::tuple(view.camera()); })
      .def("__setstate__", [](View& self, const std::tuple<Camera>& state) { new (&self) View(std::get<0>(state)); })
      .def("distance_at", &View::distance_at, "nearness"_a,
           "The distance from the eye plane, world units, at which depth images hold this nearness > 0.");

  nb::enum_<ClipDepth>(m, "ClipDepth", "What z / w is on the near and on the far plane.")
      .value("minus_one_to_one", ClipDepth::minus_one_to_one, "OpenGL.")
      .value("zero_to_one", ClipDepth::zero_to_one, "Vulkan, Direct3D, Metal, WebGPU.")
      .value("one_to_zero", ClipDepth::one_to_zero, "The same reversed.");
  m.def(
      "view_of",
      [](const ArrayLike& world_to_eye, const ArrayLike& eye_to_clip, int width, int height, ClipDepth depth) {
        return occlod::view_of(to_matrix(world_to_eye, "world_to_eye"), to_matrix(eye_to_clip, "eye_to_clip"), width,
                               height, depth);
      },
      "world_to_eye"_a, "eye_to_clip"_a, "width"_a, "height"_a, "depth"_a = ClipDepth::minus_one_to_one,
      "The view of a program that has matrices, (4, 4): a rigid motion, mirrored or not, and a projection in\n"
      "perspective, off-centre or not, with a far plane or none, or an orthographic one. Both multiply columns from "
      "the\n"
      "left, so translations are in the last column; give the transpose (.T) of matrices that multiply rows. The size\n"
      "is that of the image in pixels. The view shows what they show, also where clip space has y down; of a "
      "left-handed\n"
      "world it shows the image upside down. View.camera is the same as a Camera. Error for matrices that are none of\n"
      "these, pixels that are not square, and a near and a far plane that are not as `depth` says.");
}

}  // namespace occlod::python
