#include "backend.h"

#include <utility>

#include "occlod/base.h"
#include "occlod/visibility.h"
#ifdef OCCLOD_HAS_GL
#include "gl/backend_options.h"
#endif

namespace occlod::tool {
namespace {

#ifdef OCCLOD_HAS_GL
std::shared_ptr<gl::Context> create_context(const std::string& platform) {
  if (platform.empty()) return gl::create_any_context();
  return gl::create_context(platform == "egl" ? gl::Platform::egl : gl::Platform::osmesa);
}

std::unique_ptr<Visibility> make_gl(const BackendOptions& options, std::shared_ptr<gl::Context> context) {
  if (options.occlusion == "gl-compute") {
    gl::ComputeOcclusionOptions compute;
    compute.flight = options.flight.value_or(compute.flight);
    return gl::make_compute_occlusion(std::move(context), compute);
  }
  if (options.occlusion == "gl-mark") {
    gl::MarkOcclusionOptions mark;
    mark.flight = options.flight.value_or(mark.flight);
    mark.divisor = options.divisor.value_or(mark.divisor);
    return gl::make_mark_occlusion(std::move(context), mark);
  }
  gl::QueryOcclusionOptions query;
  query.flight = options.flight.value_or(query.flight);
  query.window = options.window.value_or(query.window);
  query.divisor = options.divisor.value_or(query.divisor);
  if (options.conservative) query.target = gl::QueryTarget::any_conservative;
  return gl::make_query_occlusion(std::move(context), query);
}

Backend make_gl_backend(const BackendOptions& options) {
  const std::shared_ptr<gl::Context> context = create_context(options.gl_platform);
  std::unique_ptr<Visibility> visibility = make_gl(options, context);
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

void refuse_if(bool given, const BackendOptions& options, const char* option, const char* owners) {
  if (given)
    throw Error({options.occlusion, option, "is not an option of this backend", std::string("use it with ") + owners});
}

void refuse_foreign_options(const BackendOptions& options) {
  const bool query = options.occlusion == "gl-query";
  const bool proxies = query || options.occlusion == "gl-mark";
  const bool gl = proxies || options.occlusion == "gl-compute";
  refuse_if(!gl && options.flight, options, "--flight", "gl-query, gl-mark or gl-compute");
  refuse_if(!query && options.window, options, "--query-window", "gl-query");
  refuse_if(!query && options.conservative, options, "--conservative-queries", "gl-query");
  refuse_if(!proxies && options.divisor, options, "--occlusion-divisor", "gl-query or gl-mark");
}

}  // namespace

Backend make_backend(const BackendOptions& options) {
  refuse_foreign_options(options);
  if (options.occlusion == "none") return {std::make_unique<NoOcclusion>(), nullptr};
  if (options.occlusion == "software") return {make_software_occlusion(), nullptr};
  return make_gl_backend(options);
}

}  // namespace occlod::tool
