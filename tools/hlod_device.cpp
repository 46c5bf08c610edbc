#include "hlod_device.h"

#include <utility>

#include "occlod/base.h"
#include "occlod/device.h"
#ifdef OCCLOD_HAS_GL
#include "occlod/gl.h"
#endif

namespace occlod::tool {
namespace {

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
  if (name == "gl" || name == "egl" || name == "osmesa") return make_gl(name);
  throw Error({"--device", name, "there is no such device", std::string("use ") + hlod_device_names});
}

}  // namespace occlod::tool
