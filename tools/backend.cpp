#include "backend.h"

#include <utility>

#include "occlod/base.h"
#include "occlod/visibility.h"
#ifdef OCCLOD_HAS_GL
#include "occlod/gl.h"
#endif

namespace occlod::tool {
namespace {

#ifdef OCCLOD_HAS_GL
std::shared_ptr<gl::Context> create_context(const std::string& device) {
  if (device == "gl") return gl::create_any_context();
  return gl::create_context(device == "egl" ? gl::Platform::egl : gl::Platform::osmesa);
}

Backend make_gl_backend(const BackendOptions& options) {
  const std::shared_ptr<gl::Context> context = create_context(options.device);
  std::unique_ptr<Visibility> visibility = gl::make_query_occlusion(context);
  Json about = {{"platform", context->platform_name()},
                {"renderer", context->renderer()},
                {"version", context->version()},
                {"flight", visibility->flight()}};
  return {std::move(visibility), std::move(about)};
}
#else
Backend make_gl_backend(const BackendOptions& options) {
  throw Error({options.occlusion, "", "this program was built without OpenGL",
               "configure the build with -DOCCLOD_BUILD_GL=ON"});
}
#endif

}  // namespace

Backend make_backend(const BackendOptions& options) {
  if (options.occlusion == "none") return {std::make_unique<NoOcclusion>(), nullptr};
  if (options.occlusion == "software") return {make_software_occlusion(), nullptr};
  return make_gl_backend(options);
}

}  // namespace occlod::tool
