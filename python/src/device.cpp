// Devices that draw HLODs, and what their commands cost.
#include "device.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>

#include "gil.h"
#include "occlod/device.h"
#include "text.h"
#ifdef OCCLOD_HAS_GL
#include "occlod/gl.h"
#endif

namespace occlod::python {
namespace {

using namespace nb::literals;
using hlod::DeviceCosts;

ItemBuffer without_items(DepthBuffer depth) {
  ItemBuffer picture;
  picture.items.assign(depth.nearness.size(), no_item);
  picture.depth = std::move(depth);
  return picture;
}

std::function<ItemBuffer()> picture_of(const hlod::SoftwareDevice& device, bool items) {
  return [&device, items] { return items ? device.items() : without_items(device.depth()); };
}

std::shared_ptr<PythonDevice> make_software(bool items) {
  auto made = std::make_shared<PythonDevice>();
  auto device = std::make_unique<hlod::SoftwareDevice>(items);
  made->picture = picture_of(*device, items);
  made->device = std::move(device);
  return made;
}

#ifdef OCCLOD_HAS_GL
std::shared_ptr<PythonDevice> make_gl(bool quality) {
  auto made = std::make_shared<PythonDevice>();
  gl::HlodDeviceOptions options;
  options.quality = quality;
  std::unique_ptr<gl::HlodDevice> device = gl::make_hlod_device(gl::create_any_context(), options);
  made->picture = [drawn = device.get()] { return without_items(drawn->read_depth()); };
  made->device = std::move(device);
  return made;
}
#else
std::shared_ptr<PythonDevice> make_gl(bool /*quality*/) {
  throw Error({"device", "gl", "this package was built without OpenGL",
               "use Device.software(), or build it with --config-settings cmake.define.OCCLOD_PYTHON_GL=ON"});
}
#endif

ItemBuffer picture(PythonDevice& device) {
  const ReleasedGil release;
  const std::scoped_lock lock(device.in_use);
  if (device.drawn == nullptr) throw Error({"device", "", "has drawn nothing", "draw a frame first"});
  return device.picture();
}

DeviceCosts measured_costs(PythonDevice& device) {
  const ReleasedGil release;
  const std::scoped_lock lock(device.in_use);
  return device.needed_costs();
}

void bind_costs(nb::module_& m) {
  nb::class_<DeviceCosts>(m, "DeviceCosts",
                          "What the commands of a device cost, ns (docs/internals/hlod.md). Of a device.")
      .def_ro("name", &DeviceCosts::name, "Of the device, or empty.")
      .def_ro("draw_ns", &DeviceCosts::draw_ns, "Set-up of a draw.")
      .def_ro("triangle_ns", &DeviceCosts::triangle_ns)
      .def_ro("fragment_ns", &DeviceCosts::fragment_ns)
      .def_ro("query_ns", &DeviceCosts::query_ns, "Set-up of a query.")
      .def_ro("query_fragment_ns", &DeviceCosts::query_fragment_ns)
      .def_ro("readback_ns", &DeviceCosts::readback_ns, "From the end of a query until it can be read.")
      .def_ro("batch_ns", &DeviceCosts::batch_ns, "Set-up of many queries at once.")
      .def_ro("batch_item_ns", &DeviceCosts::batch_item_ns, "Of each box in it.")
      .def_ro("submit_ns", &DeviceCosts::submit_ns, "Of the processor: giving one command.")
      .def_ro("visit_ns", &DeviceCosts::visit_ns, "Of the processor: looking at one node.");
}

}  // namespace

const DeviceCosts& PythonDevice::needed_costs() {
  if (!costs) costs = hlod::measure_costs(*device);
  return *costs;
}

void bind_device(nb::module_& m) {
  bind_costs(m);
  nb::class_<PythonDevice>(m, "Device",
                           "What HLODs are drawn with, and asked about. Several traversers may use one in turn.")
      .def_static("software", &make_software, nb::kw_only(), "items"_a = false,
                  "Our rasteriser, with exact counts at once. `items`: keep which triangle owns each pixel.")
      .def_static(
          "gl", &make_gl, nb::kw_only(), "quality"_a = false,
          "OpenGL, off screen, on the thread that makes it. `quality`: four samples a pixel and a dear shader.\n"
          "Error where the package was built without OpenGL or no context can be had.")
      .def_prop_ro("name", [](const PythonDevice& d) { return std::string(d.device->name()); })
      .def("costs", &measured_costs, "What commands cost: measured at the first call, in about a second.")
      .def("picture", &picture,
           "A copy of the last frame's depth and, where items are kept, of which triangle owns each pixel: triangle i "
           "of\n"
           "the k-th draw is i + the triangles of the draws before it. Without items all are NO_ID.");
}

}  // namespace occlod::python
