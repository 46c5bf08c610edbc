#include "backend.h"

#include <utility>

#include "occlod/core/error.h"
#include "occlod/occlusion/software_occlusion.h"
#ifdef OCCLOD_HAS_GL
#include "occlod/gl/context.h"
#include "occlod/gl/query_occlusion.h"
#endif

namespace occlod::tool {
namespace {

#ifdef OCCLOD_HAS_GL
std::shared_ptr<gl::Context> create_context(const std::string& platform) {
  if (platform.empty()) return gl::create_any_context();
  return gl::create_context(platform == "egl" ? gl::Platform::egl : gl::Platform::osmesa);
}

Backend make_gl_query(const BackendOptions& options) {
  std::shared_ptr<gl::Context> context = create_context(options.gl_platform);
  Json about = {
      {"platform", context->platform_name()}, {"renderer", context->renderer()}, {"version", context->version()}};
  gl::QueryOcclusionOptions query_options;
  query_options.flight = options.flight;
  return {gl::make_query_occlusion(std::move(context), query_options), std::move(about)};
}
#else
Backend make_gl_query(const BackendOptions&) {
  throw Error({"gl-query", "", "was not built", "configure with OCCLOD_BUILD_GL=ON"});
}
#endif

}  // namespace

Backend make_backend(const BackendOptions& options) {
  if (options.occlusion == "none") return {std::make_unique<NoOcclusion>(), nullptr};
  if (options.occlusion == "software") return {make_software_occlusion(), nullptr};
  return make_gl_query(options);
}

}  // namespace occlod::tool
