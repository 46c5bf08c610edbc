#include "hlod_device.h"

#include <string_view>
#include <utility>

#include "occlod/base.h"
#include "occlod/device.h"
#include "occlod/device_costs.h"
#include "occlod/trial_devices.h"
#ifdef OCCLOD_HAS_GL
#include "occlod/gl.h"
#endif

namespace occlod::tool {
namespace {

constexpr std::string_view virtual_prefix = "virtual:";

#ifdef OCCLOD_HAS_GL
HlodDevice make_gl(const std::string& name) {
  const std::shared_ptr<gl::Context> context =
      name == "gl" ? gl::create_any_context()
                   : gl::create_context(name == "egl" ? gl::Platform::egl : gl::Platform::osmesa);
  Json about = {
      {"platform", context->platform_name()}, {"renderer", context->renderer()}, {"version", context->version()}};
  return {name, gl::make_hlod_device(context), std::move(about)};
}
#else
HlodDevice make_gl(const std::string& name) {
  if (name == "gl" || name == "egl" || name == "osmesa") return make_gl(name);
  throw Error(
      {"--device", name, "this program was built without OpenGL", "configure the build with -DOCCLOD_BUILD_GL=ON"});
}
#endif

}  // namespace

HlodDevice make_hlod_device(const std::string& name) {
  if (name == "software") return {name, std::make_unique<hlod::SoftwareDevice>(), nullptr};
  if (name.starts_with(virtual_prefix))
    return {name, std::make_unique<hlod::VirtualDevice>(hlod::device_preset(name.substr(virtual_prefix.size()))),
            nullptr};
  if (name == "gl" || name == "egl" || name == "osmesa") return make_gl(name);
  throw Error({"--device", name, "there is no such device", std::string("use ") + hlod_device_names});
}

HlodDevice replaying_device(const std::string& file) {
  auto device = std::make_unique<hlod::ReplayingDevice>(hlod::read_recording(file));
  const std::string name(device->name());
  return {name, std::move(device), nullptr};
}

}  // namespace occlod::tool
